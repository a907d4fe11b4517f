#include "pipeline/frames/light_settings.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/frames/frame_list.h"
#include "pipeline/model/error.h"

namespace patchlight {

std::vector<Color> light_settings(const Job& job, const PatchSet& scene, int frame) {
  const auto& groups = scene.light_groups;
  std::vector<Color> settings(groups.size(), Color(1.0f));
  for (const auto& [name, light] : job.lights) {
    const auto found = std::find(groups.begin(), groups.end(), name);
    if (found == groups.end())
      throw Error(ExitCode::bad_config, "unknown light group `" + name + "`", job.file.string() + ", lights",
                  fmt::format("the scene has: {}", fmt::join(groups, ", ")));
    settings[found - groups.begin()] = light.color.at(frame) * float(light.scale.at(frame));
  }
  return settings;
}

void check_names(const Job& job, const PatchSet& scene) {
  light_settings(job, scene, 1);
  job_frames(job, scene);
}

}  // namespace patchlight

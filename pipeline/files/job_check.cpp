#include "pipeline/files/job_check.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/files/frame_list.h"
#include "pipeline/model/error.h"

namespace patchlight {

void check_available(const SolveConfig& solve) {
  if (solve.error_target > 0 && (solve.method != "matrix" || solve.form_factors != "rays"))
    throw Error(ExitCode::bad_config, "only `matrix` over `rays` can reach a target", "solve.error_target",
                "use them, or leave it out and raise solve.rays or solve.hemicube_resolution");
}

bool is_shardable(const SolveConfig& solve) {
  return solve.method == "matrix" && solve.form_factors == "rays" && solve.error_target == 0;
}

void check_shardable(const Job& job) {
  if (is_shardable(job.solve)) return;
  const char* key = job.solve.error_target > 0     ? "solve.error_target"
                    : job.solve.method != "matrix" ? "solve.method"
                                                   : "solve.form_factors";
  throw Error(ExitCode::bad_config, "only rows of `matrix` over `rays`, of a number that is given, come in shards",
              job.file.string() + ", " + key, "use them, or solve without --shard and --merge");
}

std::vector<Color> light_settings(const Job& job, const PatchSet& scene) {
  const auto& groups = scene.light_groups;
  std::vector<Color> settings(groups.size(), Color(1.0f));
  for (const auto& [name, light] : job.lights) {
    const auto found = std::find(groups.begin(), groups.end(), name);
    if (found == groups.end())
      throw Error(ExitCode::bad_config, "unknown light group `" + name + "`", job.file.string() + ", lights",
                  fmt::format("the scene has: {}", fmt::join(groups, ", ")));
    settings[found - groups.begin()] = light.color * float(light.scale);
  }
  return settings;
}

void check_names(const Job& job, const PatchSet& scene) {
  light_settings(job, scene);
  job_frames(job, scene);
}

}  // namespace patchlight

#include "pipeline/files/frame_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>
#include <set>

#include "pipeline/model/error.h"

namespace patchlight {

namespace {

/// A file name for each camera: other characters than letters, digits, `.`, `_` and `-` become `_`; clashes get `_2`,
/// ...
std::vector<std::string> file_names(const std::vector<Camera>& cameras) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const Camera& camera : cameras) {
    std::string name = camera.name.substr(0, 200);
    for (char& c : name)
      if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '_' && c != '-') c = '_';
    std::string unique = name;
    for (int k = 2; !taken.insert(unique).second; ++k) unique = fmt::format("{}_{}", name, k);
    names.push_back(unique);
  }
  return names;
}

std::vector<std::size_t> chosen_cameras(const Job& job, const PatchSet& scene) {
  std::vector<std::size_t> chosen(scene.cameras.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t(0));
  if (job.trace.cameras.empty()) return chosen;
  chosen.clear();
  for (const std::string& name : job.trace.cameras) {
    const std::size_t before = chosen.size();
    for (std::size_t i = 0; i < scene.cameras.size(); ++i)
      if (scene.cameras[i].name == name) chosen.push_back(i);
    if (chosen.size() > before) continue;
    std::vector<std::string> known;
    for (const Camera& camera : scene.cameras) known.push_back(camera.name);
    throw Error(ExitCode::bad_config, "unknown camera `" + name + "`", job.file.string() + ", trace.cameras",
                fmt::format("the scene has: {}", fmt::join(known, ", ")));
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

}  // namespace

std::vector<Frame> job_frames(const Job& job, const PatchSet& scene) {
  const std::vector<std::string> names = file_names(scene.cameras);
  std::vector<Frame> frames;
  for (const std::size_t camera : chosen_cameras(job, scene)) {
    Frame frame{camera, 1, {}, {}};
    const std::string stem = fmt::format("{}.{:04}", names[camera], frame.number);
    frame.exr = job.frame_folder() / (stem + ".exr");
    frame.png = job.frame_folder() / (stem + ".png");
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace patchlight

#include "pipeline/frames/frame_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "pipeline/frames/camera_view.h"
#include "pipeline/frames/light_settings.h"
#include "pipeline/image/image_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

constexpr std::size_t kMaxNames = 5;

std::map<std::string, std::string> metadata_of(const Frame& frame) {
  try {
    return read_exr_header(frame.exr).metadata;
  } catch (const Error&) {
    return {};
  }
}

/// Frames of one camera after another, as `Camera` or `Camera, frames 3 to 9`.
std::string names(const std::vector<const Frame*>& frames) {
  std::vector<std::string> cameras;
  for (std::size_t i = 0, end = 0; i < frames.size(); i = end) {
    while (end < frames.size() && frames[end]->camera.name == frames[i]->camera.name) ++end;
    const int first = frames[i]->number, last = frames[end - 1]->number;
    std::string name = "`" + frames[i]->camera.name + "`";
    if (first != last) name += fmt::format(" in {} frames from {} to {}", end - i, first, last);
    if (first == last && first != 1) name += fmt::format(" in frame {}", first);
    cameras.push_back(name);
  }
  const std::size_t shown = std::min(cameras.size(), kMaxNames);
  const std::string more = cameras.size() > shown ? fmt::format(" and {} more", cameras.size() - shown) : "";
  return fmt::format("{}{}", fmt::join(cameras.begin(), cameras.begin() + std::ptrdiff_t(shown), ", "), more);
}

std::string reason_for_black(const Job& job, const PatchSet& scene, int frame) {
  const std::vector<Color> settings = light_settings(job, scene, frame);
  if (std::all_of(settings.begin(), settings.end(), [](const Color& color) { return color == Color(0.0f); }))
    return "the job's `lights` turn every light group off; raise a scale or a colour";
  return "no light reaches the surfaces in view, or they show their backs, which are black; move the camera, add a "
         "light, make the material double-sided, or set `trace.cull_backfaces: true`";
}

}  // namespace

std::vector<std::string> frame_warnings(const Job& job, const PatchSet& scene, const std::vector<Frame>& frames) {
  const Imath::Box3d bounds = bounds_of(scene.primitives);
  std::vector<const Frame*> without_view, black, dark;
  double brightest = 0.0;  // of the dark frames
  for (const Frame& frame : frames) {
    if (misses(frame.camera, double(frame.size[0]) / frame.size[1], bounds)) {
      without_view.push_back(&frame);
      continue;
    }
    const auto metadata = metadata_of(frame);
    if (!scene.light_groups.empty() && metadata.contains(kBlackFrame)) black.push_back(&frame);
    const auto radiance = metadata.find(kDarkFrame);
    if (radiance == metadata.end()) continue;
    dark.push_back(&frame);
    brightest = std::max(brightest, std::strtod(radiance->second.c_str(), nullptr));
  }
  std::vector<std::string> warnings;
  if (!without_view.empty())
    warnings.push_back(fmt::format(
        "a camera stands outside the scene and sees nothing of it ({}): turn or move it, change its `znear` and `zfar` "
        "if it has any, or leave it out of `trace.cameras`",
        names(without_view)));
  if (!black.empty())
    warnings.push_back(
        fmt::format("a frame is black ({}): {}", names(black), reason_for_black(job, scene, black[0]->number)));
  if (!dark.empty())
    warnings.push_back(fmt::format(
        "a frame is nearly black ({}): its brightest pixel is {:.2g} W/(m2 sr), so the picture shows nothing; "
        "are the lights as strong as they should be? If so, raise `trace.exposure`",
        names(dark), brightest));
  return warnings;
}

}  // namespace patchlight

#include "pipeline/frames/frame_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>
#include <set>

#include "pipeline/frames/frame_camera.h"
#include "pipeline/job/frame_range.h"
#include "pipeline/job/frame_size.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

constexpr std::size_t kMaxFileNameBytes = 255;
constexpr std::size_t kMaxSuffixBytes = 12;  // .1000000.exr

/// Replaces each UTF-8 character other than ASCII letters, digits, `.`, `_` and `-` by one `_`.
std::string sanitized_name(const std::string& name) {
  std::string sanitized;
  int continuation_bytes = 0;  // remaining bytes of the current character
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (continuation_bytes > 0 && (byte & 0xc0) == 0x80) {
      --continuation_bytes;
      continue;
    }
    continuation_bytes = byte >= 0xf0 ? 3 : byte >= 0xe0 ? 2 : byte >= 0xc0 ? 1 : 0;
    const bool is_allowed = byte < 0x80 && (std::isalnum(byte) || c == '.' || c == '_' || c == '-');
    sanitized += is_allowed ? c : '_';
  }
  return sanitized;
}

/// A unique file name for each camera, without suffix; duplicates get `_2`, ...
std::vector<std::string> file_names(const std::vector<FrameCamera>& cameras) {
  std::vector<std::string> names;
  std::set<std::string> used;
  for (const FrameCamera& camera : cameras) {
    const std::string name = sanitized_name(camera.name);
    std::string ending;
    const auto unique = [&] { return name.substr(0, kMaxFileNameBytes - kMaxSuffixBytes - ending.size()) + ending; };
    for (int k = 2; !used.insert(unique()).second; ++k) ending = fmt::format("_{}", k);
    names.push_back(unique());
  }
  return names;
}

std::vector<std::size_t> chosen_cameras(const Job& job, const std::vector<FrameCamera>& cameras) {
  std::vector<std::size_t> chosen(cameras.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t(0));
  if (job.trace.cameras.empty()) return chosen;
  chosen.clear();
  for (const std::string& name : job.trace.cameras) {
    const std::size_t before = chosen.size();
    for (std::size_t i = 0; i < cameras.size(); ++i)
      if (cameras[i].name == name) chosen.push_back(i);
    if (chosen.size() > before) continue;
    std::vector<std::string> known;
    for (const FrameCamera& camera : cameras) known.push_back(camera.name);
    throw Error(ExitCode::bad_config, "unknown camera `" + name + "`", job.file.string() + ", trace.cameras",
                fmt::format("the scene has: {}", fmt::join(known, ", ")));
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

}  // namespace

std::vector<Frame> job_frames(const Job& job, const PatchSet& scene) {
  const std::vector<FrameCamera> cameras = frame_cameras(job, scene);
  const std::vector<std::string> names = file_names(cameras);
  const std::vector<int> requested = frame_numbers(job.trace.frames), first{1};
  const bool lights_change =
      std::any_of(job.lights.begin(), job.lights.end(), [](const auto& light) { return light.second.is_animated(); });
  std::vector<Frame> frames;
  for (const std::size_t i : chosen_cameras(job, cameras)) {
    const std::vector<int>& numbers = cameras[i].moves() || lights_change ? requested : first;
    if (frames.size() + numbers.size() > kMaxFrames)
      throw Error(ExitCode::over_limit, fmt::format("more than {} frames of all cameras", kMaxFrames),
                  job.file.string() + ", trace.frames", "name fewer frames, or fewer trace.cameras");
    for (const int number : numbers) {
      const std::string stem = fmt::format("{}.{:04}", names[i], number);
      const Camera camera = cameras[i].at(number, job);
      frames.push_back({camera, frame_size(job.trace, camera), number, job.frame_folder() / (stem + ".exr"),
                        job.frame_folder() / (stem + ".png")});
    }
  }
  return frames;
}

Frame relit_frame(const Job& job, const Frame& frame) {
  Frame relit = frame;
  relit.exr = job.relit_folder() / frame.exr.filename();
  relit.png = job.relit_folder() / frame.png.filename();
  return relit;
}

}  // namespace patchlight

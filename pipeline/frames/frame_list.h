#pragma once
#include <array>
#include <filesystem>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// A frame of a job and its output files.
struct Frame {
  Camera camera;              ///< The camera at this frame.
  std::array<int, 2> size{};  ///< Width and height in pixels.
  int number = 1;
  std::filesystem::path exr;
  std::filesystem::path png;
};

/// The frames that a job requests, camera by camera; a static camera under lights that
/// do not change has only frame 1.
/// Throws: Error (bad_config) for an unknown camera or a lens that cannot be, (over_limit) for too many frames,
/// (bad_data) for a camera whose transform is degenerate at a frame.
std::vector<Frame> job_frames(const Job& job, const PatchSet& scene);

/// The same frame with the files of its relit version.
Frame relit_frame(const Job& job, const Frame& frame);

}  // namespace patchlight

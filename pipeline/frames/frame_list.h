#pragma once
#include <filesystem>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// One frame of a job and the files that it is written to.
struct Frame {
  Camera camera;  ///< As it stands at this frame.
  int number = 1;
  std::filesystem::path exr;
  std::filesystem::path png;
};

/// The frames that a job asks for, camera by camera; cameras that stand still have frame 1 alone.
/// Throws: Error (bad_config) for a camera that the scene does not have, (over_limit) for too many frames, (bad_data)
/// for a frame at which a camera makes no picture.
std::vector<Frame> job_frames(const Job& job, const PatchSet& scene);

/// The same frame where it stands relit.
Frame relit_frame(const Job& job, const Frame& frame);

}  // namespace patchlight

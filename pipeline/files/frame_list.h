#pragma once
#include <filesystem>
#include <vector>

#include "pipeline/files/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// One frame of a job and the files that it is written to.
struct Frame {
  std::size_t camera = 0;  ///< Index into PatchSet::cameras.
  int number = 1;
  std::filesystem::path exr;
  std::filesystem::path png;
};

/// The frames that a job asks for, in order.
/// Throws: Error (bad_config) for a camera that the scene does not have.
std::vector<Frame> job_frames(const Job& job, const PatchSet& scene);

}  // namespace patchlight

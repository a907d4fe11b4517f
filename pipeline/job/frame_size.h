#pragma once
#include <array>

#include "pipeline/job/job.h"
#include "pipeline/model/camera.h"

namespace patchlight {

/// Width and height of a camera's frames in pixels: those of the job or, if it has none, even numbers in the camera's
/// aspect ratio with about as many pixels as 640 x 480. Of the heights within 2.5% of that, the one with the least
/// error of the aspect ratio counts.
std::array<int, 2> frame_size(const TraceConfig& config, const Camera& camera);

}  // namespace patchlight

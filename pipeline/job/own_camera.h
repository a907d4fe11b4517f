#pragma once
#include <optional>
#include <string>

#include "pipeline/job/job.h"
#include "pipeline/model/camera.h"

namespace patchlight {

/// A camera defined by the job, at a frame; nothing if its view direction is undefined.
std::optional<Camera> own_camera(const std::string& name, const CameraConfig& config, int frame);

}  // namespace patchlight

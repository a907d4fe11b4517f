#pragma once
#include <optional>
#include <string>

#include "pipeline/job/job.h"
#include "pipeline/model/camera.h"

namespace patchlight {

/// A camera defined by the job, at a frame; nothing if its view direction is undefined.
std::optional<Camera> own_camera(const std::string& name, const CameraConfig& config, int frame);

/// Changes a camera's projection and lens to what the job sets of them.
void set_lens(const CameraConfig& config, Camera& camera);

}  // namespace patchlight

#pragma once
#include <optional>
#include <string>

#include "pipeline/job/job.h"
#include "pipeline/model/camera.h"

namespace patchlight {

/// A camera of the job's own as it stands at a frame; nothing where it looks nowhere.
std::optional<Camera> own_camera(const std::string& name, const CameraConfig& config, int frame);

}  // namespace patchlight

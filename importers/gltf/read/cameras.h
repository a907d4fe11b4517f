#pragma once
#include <optional>
#include <string>
#include <vector>

#include "pipeline/model/camera.h"

namespace tinygltf {
struct Camera;
}

namespace patchlight {

/// A node's camera; nothing if its field of view or its transform is invalid.
std::optional<Camera> read_camera(const tinygltf::Camera& source, const Matrix4& to_world, const std::string& node);

/// A camera named `default` that shows the whole box from its +Z side, looking slightly down.
Camera framing_camera(const Vec3d& box_min, const Vec3d& box_max);

}  // namespace patchlight

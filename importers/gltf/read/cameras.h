#pragma once
#include <optional>
#include <string>
#include <vector>

#include "importers/gltf/check/gltf_check.h"
#include "pipeline/model/camera.h"
#include "pipeline/stage/progress.h"

namespace tinygltf {
struct Camera;
}

namespace patchlight {

/// A node's camera, with the lens of its extras; nothing if its field of view or its transform is invalid. Clip depths
/// that leave nothing are ignored with a warning.
std::optional<Camera> read_camera(const tinygltf::Camera& source, const GltfLens& lens, const Matrix4& to_world,
                                  const std::string& node, Progress& progress);

/// A camera named `default` that shows the whole box from its +Z side, looking slightly down.
Camera framing_camera(const Vec3d& box_min, const Vec3d& box_max);

}  // namespace patchlight

#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/model/motion.h"

namespace patchlight {

/// A glTF camera in world space: it looks along its local -Z, with +Y up.
struct Camera {
  enum class Projection : std::int32_t { perspective = 0, orthographic = 1 };

  std::string name;  ///< Name of the glTF node, or of the camera in the job.
  Projection projection = Projection::perspective;
  Matrix4 to_world;           ///< Rigid. For an animated camera: the transform without animation.
  double vertical = 0.7;      ///< Perspective: full vertical field of view, rad. Orthographic: half height, m.
  double aspect = 4.0 / 3.0;  ///< Width over height in the scene file; frames use the resolution's instead.
  /// Animated camera: factors of its transform, from camera space to world space. Empty: a static camera.
  std::vector<Motion> motion;
};

/// The rigid camera frame of a transform: removes scale, shear and mirroring, keeps the view direction and then the up
/// direction. Empty if the transform is degenerate.
std::optional<Matrix4> rigid_frame(const Matrix4& to_world);

/// The rigid frame of an animated camera at a time in s; empty if its transform is degenerate at that time.
std::optional<Matrix4> to_world_at(const Camera& camera, double seconds);

}  // namespace patchlight

#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/model/motion.h"

namespace patchlight {

/// A glTF camera in the world: it looks along its local -Z, +Y up.
struct Camera {
  enum class Projection : std::int32_t { perspective = 0, orthographic = 1 };

  std::string name;  ///< Of the glTF node, or the job's.
  Projection projection = Projection::perspective;
  Matrix4 to_world;           ///< Rigid. Of a camera that moves: at rest.
  double vertical = 0.7;      ///< Perspective: full vertical angle, rad. Orthographic: half height, m.
  double aspect = 4.0 / 3.0;  ///< Width over height where the file states one; frames take theirs from the resolution.
  /// Of a camera that moves: factors of its transform, from its own axes to the world. Empty: it stands still.
  std::vector<Motion> motion;
};

/// A rigid camera frame from a transform: scale, shear and mirroring are taken out, the view direction and then the up
/// direction kept. Nothing where the transform leaves no such directions.
std::optional<Matrix4> rigid_frame(const Matrix4& to_world);

/// Where a camera that moves stands at a time in s; nothing where its transform then can make no picture.
std::optional<Matrix4> to_world_at(const Camera& camera, double seconds);

}  // namespace patchlight

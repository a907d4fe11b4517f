#pragma once
#include <cstdint>
#include <string>

#include "pipeline/model/math.h"

namespace patchlight {

/// A glTF camera in the world: it looks along its local -Z, +Y up.
struct Camera {
  enum class Projection : std::int32_t { perspective = 0, orthographic = 1 };

  std::string name;  ///< Of the glTF node.
  Projection projection = Projection::perspective;
  Matrix4 to_world;
  double vertical = 0.7;      ///< Perspective: full vertical angle, rad. Orthographic: half height, m.
  double aspect = 4.0 / 3.0;  ///< Width over height where the file states one; frames take theirs from the resolution.
};

}  // namespace patchlight

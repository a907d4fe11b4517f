#pragma once
#include <cstdint>
#include <string>

#include "pipeline/model/math.h"

namespace patchlight {

/// A light that no surface is (KHR_lights_punctual): cameras and mirrors do not see it, and without an extent its
/// shadows are sharp.
struct Light {
  enum class Kind : std::int32_t { point = 0, spot = 1, sun = 2 };

  std::string name;  ///< Of the glTF node.
  Kind kind = Kind::point;
  std::int32_t light_group = 0;     ///< Index into PatchSet::light_groups.
  Color strength{0.0f};             ///< Radiant intensity, W/sr, of a spot along its axis; of a sun irradiance, W/m2.
  Vec3d position{0.0};              ///< m; zero for a sun.
  Vec3d direction{0.0, 0.0, -1.0};  ///< Unit vector along the light of a spot or a sun.
  double inner = 0.0, outer = 0.0;  ///< Of a spot: half the angles of its cones, rad. A sun has a radius of `outer`.
};

}  // namespace patchlight

#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

constexpr double kMaxLightRadius = 1e6;  ///< m
constexpr double kMaxSunAngle = 180.0;   ///< Degrees.

/// Radiant intensity of a luminaire by direction, relative to the largest. Lights of one photometric file share it.
struct LightDistribution {
  /// Coordinates, by the number that LM-63 gives them: see relative_intensity().
  enum class System : std::int32_t { c = 1, b = 2, a = 3 };

  System system = System::c;
  std::vector<double> vertical;    ///< Angles, degrees, ascending. There is no light beyond them.
  std::vector<double> horizontal;  ///< Likewise; of type C from 0 or less to 360 or more, or one: all are the same.
  std::vector<float> intensity;    ///< [horizontal][vertical], in [0,1].
};

/// A light without a surface (KHR_lights_punctual): invisible to cameras and mirrors. Point lights, spots and suns
/// of radius 0 cast sharp shadows.
struct Light {
  enum class Kind : std::int32_t { point = 0, spot = 1, sun = 2 };
  static constexpr std::array kKindNames{"point", "spot", "sun"};  ///< By Kind.

  std::string name;  ///< Name of the glTF node.
  Kind kind = Kind::point;
  std::int32_t light_group = 0;     ///< Index into PatchSet::light_groups.
  Color strength{0.0f};             ///< Radiant intensity, W/sr (the largest one); of a sun: irradiance, W/m2.
  Vec3d position{0.0};              ///< m; zero for a sun.
  Vec3d direction{0.0, 0.0, -1.0};  ///< Unit vector along which a spot or a sun emits; nadir of a distribution.
  double inner = 0.0, outer = 0.0;  ///< Spot: half angles of its cones, rad. Sun: `outer` is its angular radius.
  double radius = 0.0;              ///< Of a point light or spot, m: a sphere of uniform radiance, which hides nothing.
  std::int32_t distribution = -1;   ///< Of a point light: index into PatchSet::distributions; -1: it emits evenly.
  Vec3d across{1.0, 0.0, 0.0};      ///< Unit vector at right angles to `direction`: half-plane C0 of a distribution.
};

}  // namespace patchlight

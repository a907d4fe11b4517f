#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// One factor of an animated transform: glTF keyframes, or a fixed matrix.
struct Motion {
  enum class Kind : std::int32_t { fixed = 0, translation = 1, rotation = 2, scale = 3 };
  enum class Interpolation : std::int32_t { step = 0, linear = 1, cubic_spline = 2 };

  Kind kind = Kind::fixed;
  Interpolation interpolation = Interpolation::linear;
  std::vector<double> times;  ///< Keyframe times, s, in ascending order; empty if fixed.
  /// Keyframe by keyframe: a translation or scale x, y, z, or a quaternion x, y, z, w. For cubic splines each keyframe
  /// has an in-tangent, a value and an out-tangent. Fixed: a matrix in row-major order.
  std::vector<double> values;

  /// Number of components of one value.
  int width() const { return kind == Kind::fixed ? 16 : kind == Kind::rotation ? 4 : 3; }
  /// Number of components of one keyframe, or of the fixed matrix.
  int stride() const {
    return interpolation == Interpolation::cubic_spline && kind != Kind::fixed ? 3 * width() : width();
  }
};

/// The factor at a time in s; constant before the first and after the last keyframe.
Matrix4 matrix_at(const Motion& motion, double seconds);

/// The rotation of a quaternion x, y, z, w of any length; the identity for length 0.
Matrix4 rotation_matrix(const std::array<double, 4>& quaternion);

}  // namespace patchlight

#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// One factor of a transform that changes with time, by keyframes as glTF has them; or one that does not.
struct Motion {
  enum class Kind : std::int32_t { fixed = 0, translation = 1, rotation = 2, scale = 3 };
  enum class Interpolation : std::int32_t { step = 0, linear = 1, cubic_spline = 2 };

  Kind kind = Kind::fixed;
  Interpolation interpolation = Interpolation::linear;
  std::vector<double> times;  ///< s, never falling; none if fixed.
  /// Of each keyframe, one after the other: translation or scale by axis, or a quaternion x, y, z, w; by cubic spline
  /// these three times, as in-tangent, value and out-tangent. Fixed: a matrix in rows.
  std::vector<double> values;

  /// Numbers of one value.
  int width() const { return kind == Kind::fixed ? 16 : kind == Kind::rotation ? 4 : 3; }
  /// Numbers of one keyframe, or of what is fixed.
  int stride() const {
    return interpolation == Interpolation::cubic_spline && kind != Kind::fixed ? 3 * width() : width();
  }
};

/// The factor at a time in s; before the first and after the last keyframe it stays.
Matrix4 matrix_at(const Motion& motion, double seconds);

/// Of a quaternion x, y, z, w of any length; the identity for one without length.
Matrix4 rotation_matrix(const std::array<double, 4>& quaternion);

}  // namespace patchlight

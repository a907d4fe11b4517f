#pragma once
#include <cmath>

#include "pipeline/model/math.h"
#include "pipeline/optics/intersect/packet_kernel.h"

namespace patchlight {

using packet::kUnitRoundoff;

/// Sum of |a_k b_k|: times the relative error of b's coordinates, a bound of the error of a ^ b.
inline double absolute_dot(const Vec3d& a, const Vec3d& b) {
  return std::abs(a.x * b.x) + std::abs(a.y * b.y) + std::abs(a.z * b.z);
}

}  // namespace patchlight

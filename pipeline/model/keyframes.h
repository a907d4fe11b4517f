#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "pipeline/model/motion.h"

namespace patchlight {

/// Keyframes as glTF has them, wherever they stand.
struct Keyframes {
  std::size_t count = 0;  ///< At least one.
  Motion::Interpolation interpolation = Motion::Interpolation::linear;
  bool turn = false;                            ///< Whether values are quaternions x, y, z, w.
  std::function<double(std::size_t key)> time;  ///< s, never falling.
  /// `part` is 1; by cubic spline also 0 for the in-tangent and 2 for the out-tangent.
  std::function<std::vector<double>(std::size_t key, int part)> value;
};

/// The value at a time in s; before the first and after the last keyframe it stays. Source: glTF 2.0, appendix C.
std::vector<double> value_at(const Keyframes& keyframes, double seconds);

}  // namespace patchlight

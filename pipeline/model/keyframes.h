#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "pipeline/model/motion.h"

namespace patchlight {

/// Access to glTF keyframes, wherever they are stored.
struct Keyframes {
  std::size_t count = 0;  ///< Number of keyframes, at least one.
  Motion::Interpolation interpolation = Motion::Interpolation::linear;
  bool turn = false;                            ///< Whether values are rotations: quaternions x, y, z, w.
  std::function<double(std::size_t key)> time;  ///< s, in ascending order.
  /// `part` 1 is the value; for cubic splines, 0 is the in-tangent and 2 the out-tangent.
  std::function<std::vector<double>(std::size_t key, int part)> value;
};

/// The value at a time in s; constant before the first and after the last keyframe. Source: glTF 2.0, appendix C.
std::vector<double> value_at(const Keyframes& keyframes, double seconds);

}  // namespace patchlight

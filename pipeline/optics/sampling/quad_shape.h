#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// (a, b) of a planar quad: corner 2 = corner 0 + a (corner 1 - corner 0) + b (corner 3 - corner 0). (1, 1) for a
/// parallelogram, (0, 1) for a triangle.
Vec2f quad_shape(const std::array<Vec3d, 4>& corners);

/// (u,v), each in [0,1], of the point (s, t) in the frame of the edges at corner 0, for a quad of shape (a, b): solves
/// s = u (1 + v (a - 1)), t = v (1 + u (b - 1)).
inline Vec2f inverse_bilinear(float a, float b, float s, float t) {
  const float k = a - 1.0f;
  const float linear = 1.0f + (b - 1.0f) * s - t * k;
  float v = t / linear;
  if (k != 0.0f) {
    const float root = std::sqrt(std::max(0.0f, linear * linear + 4.0f * k * t));
    v = 2.0f * t / (linear + root);
  }
  v = std::clamp(v, 0.0f, 1.0f);
  const float width = 1.0f + v * k;
  return {width > 0.0f ? std::clamp(s / width, 0.0f, 1.0f) : 0.5f, v};
}

}  // namespace patchlight

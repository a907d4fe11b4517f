#pragma once
#include <array>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// (a, b) of a planar quad: corner 2 = corner 0 + a (corner 1 - corner 0) + b (corner 3 - corner 0). (1, 1) for a
/// parallelogram, (0, 1) for a triangle.
Vec2f quad_shape(const std::array<Vec3d, 4>& corners);

/// (u,v), each in [0,1], of the point (s, t) in the frame of the edges at corner 0, for a quad of shape (a, b): solves
/// s = u (1 + v (a - 1)), t = v (1 + u (b - 1)).
Vec2f inverse_bilinear(float a, float b, float s, float t);

}  // namespace patchlight

#pragma once
#include <array>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// Twice the signed area of the triangle a, b, p: positive to the left of a to b.
inline double side_of(const Vec2d& a, const Vec2d& b, const Vec2d& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

using Polygon = std::vector<Vec2d>;  ///< A convex polygon's corners, counter-clockwise, in a PlaneFrame, m.

double area_of(const Polygon& polygon);
Vec2d centroid_of(const Polygon& polygon);

/// The part of a polygon inside of another; no corners if there is none.
Polygon intersection(Polygon polygon, const Polygon& other);

/// The parts of a polygon to the left (first) and to the right of the line through a and b.
std::array<Polygon, 2> split(const Polygon& polygon, const Vec2d& a, const Vec2d& b);

}  // namespace patchlight

#include "pipeline/model/region.h"

namespace patchlight {

double Region::area() const {
  double area = 0;
  for (const auto& c : pieces) area += 0.5 * (c[2] - c[0]).cross(c[3] - c[1]);
  return area;
}

Region Region::mirrored() const {
  const auto mirror = [](const Vec2d& p) { return Vec2d(1 - p.x, p.y); };
  Region result;
  for (const auto& c : pieces) {
    if (c[2] == c[3])
      result.pieces.push_back({mirror(c[1]), mirror(c[0]), mirror(c[2]), mirror(c[2])});
    else
      result.pieces.push_back({mirror(c[1]), mirror(c[0]), mirror(c[3]), mirror(c[2])});
  }
  for (const auto& [from, to] : edges) result.edges.push_back({mirror(to), mirror(from)});
  return result;
}

}  // namespace patchlight

#include "pipeline/model/cuts/polygon.h"

#include <utility>

namespace patchlight {

double area_of(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t k = 2; k < polygon.size(); ++k) twice += side_of(polygon[0], polygon[k - 1], polygon[k]);
  return 0.5 * twice;
}

Vec2d centroid_of(const Polygon& polygon) {
  Vec2d sum(0.0);
  double total = 0;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const double weight = side_of(polygon[0], polygon[k - 1], polygon[k]);
    sum += (polygon[k - 1] - polygon[0] + polygon[k] - polygon[0]) * (weight / 3);
    total += weight;
  }
  return polygon[0] + sum / total;
}

Polygon intersection(Polygon polygon, const Polygon& other) {
  for (std::size_t k = 0; k < other.size() && polygon.size() >= 3; ++k)
    polygon = std::move(split(polygon, other[k], other[(k + 1) % other.size()])[0]);
  return polygon;
}

std::array<Polygon, 2> split(const Polygon& polygon, const Vec2d& a, const Vec2d& b) {
  std::array<Polygon, 2> sides;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2d &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    const double at_p = side_of(a, b, p), at_q = side_of(a, b, q);
    if (at_p >= 0) sides[0].push_back(p);
    if (at_p <= 0) sides[1].push_back(p);
    if ((at_p < 0) == (at_q < 0) || at_p == 0 || at_q == 0) continue;
    const Vec2d between = p + (q - p) * (at_p / (at_p - at_q));
    for (Polygon& side : sides) side.push_back(between);
  }
  return sides;
}

}  // namespace patchlight

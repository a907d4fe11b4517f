#include "pipeline/model/cuts/polygon.h"

#include <utility>

namespace patchlight {

namespace {

/// Appends the corners of a polygon's parts to the left and to the right of the line through a and b; null: not asked
/// for.
void cut(const Polygon& polygon, const Vec2d& a, const Vec2d& b, Polygon* left, Polygon* right) {
  if (polygon.empty()) return;
  const double at_first = side_of(a, b, polygon[0]);
  double at_p = at_first;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const bool last = k + 1 == polygon.size();
    const Vec2d &p = polygon[k], &q = polygon[last ? 0 : k + 1];
    const double at_q = last ? at_first : side_of(a, b, q);
    if (left && at_p >= 0) left->push_back(p);
    if (right && at_p <= 0) right->push_back(p);
    if ((at_p < 0) != (at_q < 0) && at_p != 0 && at_q != 0) {
      const Vec2d between = p + (q - p) * (at_p / (at_p - at_q));
      if (left) left->push_back(between);
      if (right) right->push_back(between);
    }
    at_p = at_q;
  }
}

}  // namespace

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
  Polygon left;
  for (std::size_t k = 0; k < other.size() && polygon.size() >= 3; ++k) {
    left.clear();
    cut(polygon, other[k], other[(k + 1) % other.size()], &left, nullptr);
    std::swap(polygon, left);
  }
  return polygon;
}

std::array<Polygon, 2> split(const Polygon& polygon, const Vec2d& a, const Vec2d& b) {
  std::array<Polygon, 2> sides;
  for (Polygon& side : sides) side.reserve(polygon.size() + 1);
  cut(polygon, a, b, &sides[0], &sides[1]);
  return sides;
}

}  // namespace patchlight

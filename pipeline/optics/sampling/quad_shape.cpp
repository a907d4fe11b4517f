#include "pipeline/optics/sampling/quad_shape.h"

#include <cmath>

namespace patchlight {

Vec2f quad_shape(const std::array<Vec3d, 4>& c) {
  if (c[2] == c[3]) return {0.0f, 1.0f};
  const Vec3d e1 = c[1] - c[0], e3 = c[3] - c[0], d = c[2] - c[0];
  const Vec3d normal = e1 % e3;
  const double scale = 1.0 / (normal ^ normal);
  const auto snapped = [](double x) { return std::abs(x - 1.0) < 1e-5 ? 1.0f : float(x); };
  return {snapped(((d % e3) ^ normal) * scale), snapped(((e1 % d) ^ normal) * scale)};
}

}  // namespace patchlight

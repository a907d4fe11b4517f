#include "pipeline/optics/surface/smooth_normals.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

/// Bilinear weights of the corners at (u,v).
template <class Number>
std::array<Number, 4> corner_weights(Number u, Number v) {
  return {(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v};
}

}  // namespace

Vec3f SmoothNormals::interpolated(std::int32_t i, float u, float v, const Vec3f& flat) const {
  const std::array<float, 4> weights = corner_weights(u, v);
  Vec3f normal(0.0f);
  for (int k = 0; k < 4; ++k) normal += scene_.normals[i][k] * weights[k];
  const float length = normal.length();
  return length > 0 ? normal / length : flat;
}

Vec3d SmoothNormals::lifted(std::int32_t i, float u, float v, const Vec3d& point) const {
  const std::array<double, 4> weights = corner_weights(double(u), double(v));
  Vec3d result = point;
  for (int k = 0; k < 4; ++k) {
    const Vec3d normal(scene_.normals[i][k]);
    const double height = (point - scene_.primitives[i].corners[k]) ^ normal;  // above the corner's tangent plane
    result -= normal * (weights[k] * std::min(0.0, height));
  }
  return result;
}

/// At an angle x of the normal to `flat`, in the plane of both, the mirror image has the height a sin(2x) + b cos(2x),
/// where a and b are the direction's components along and out of the surface.
Vec3f valid_for_viewer(const Vec3f& normal, const Vec3f& flat, const Vec3f& to_viewer) {
  constexpr float kLeastHeight = 0.01f, kOfViewer = 0.9f;  // of the mirror image
  const float b = to_viewer ^ flat;
  const float height = std::min(kLeastHeight, kOfViewer * b);
  if (2 * (normal ^ to_viewer) * (normal ^ flat) - b >= height || b <= 0) return normal;
  const Vec3f along = (normal - flat * (normal ^ flat)).normalized();
  const float a = to_viewer ^ along;
  const float x = 0.5f * (std::atan2(a, b) + std::acos(std::min(1.0f, height / std::hypot(a, b))));
  return along * std::sin(x) + flat * std::cos(x);
}

}  // namespace patchlight

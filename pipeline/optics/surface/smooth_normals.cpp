#include "pipeline/optics/surface/smooth_normals.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/surface/texture_lookup.h"

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

Vec3f SmoothNormals::turned_by_texture(std::int32_t i, float u, float v, const Vec3f& smooth) const {
  const Primitive& p = scene_.primitives[i];
  const Texcoords& t = normal_texcoords(scene_, i);
  const auto& c = p.corners;
  const Vec3f along_u((c[1] - c[0]) * double(1 - v) + (c[2] - c[3]) * double(v));
  const Vec3f along_v((c[3] - c[0]) * double(1 - u) + (c[2] - c[1]) * double(u));
  const Vec2f by_u = (t[1] - t[0]) * (1 - v) + (t[2] - t[3]) * v, by_v = (t[3] - t[0]) * (1 - u) + (t[2] - t[1]) * u;
  const float turn = by_u.x * by_v.y - by_u.y * by_v.x < 0 ? -1.0f : 1.0f;  // mirrored coordinates
  Vec3f right = (along_u * by_v.y - along_v * by_u.y) * turn, up = (along_u * by_v.x - along_v * by_u.x) * turn;
  right -= smooth * (right ^ smooth);
  if (!(right.length2() > 0) || p.shape != Primitive::Shape::quad) return smooth;
  right.normalize();
  const Vec3f across = smooth % right;
  up = (up ^ across) < 0 ? -across : across;
  const Vec3f texel = tangent_space_normal(scene_, i, double(u), double(v));
  const float scale = scene_.materials[p.material].normal_scale * (p.back >= 0 && p.back < i ? -1.0f : 1.0f);
  const Vec3f turned = right * (texel.x * scale) + up * (texel.y * scale) + smooth * texel.z;
  return turned.length2() > 0 ? turned.normalized() : smooth;
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

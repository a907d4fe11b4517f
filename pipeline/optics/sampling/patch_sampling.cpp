#include "pipeline/optics/sampling/patch_sampling.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/quad_shape.h"

namespace patchlight {

namespace {

/// Inverts the CDF of the density that is linear from a to b over [0,1] (Pharr et al. 2023, section A.5.1).
double sample_linear(double x, double a, double b) {
  if (a == b) return x;
  return std::min(x * (a + b) / (a + std::sqrt((1 - x) * a * a + x * b * b)), 1.0);
}

double area_density(const std::array<Vec3d, 4>& c, double u, double v) {
  const Vec3d du = (c[1] - c[0]) * (1 - v) + (c[2] - c[3]) * v;
  const Vec3d dv = (c[3] - c[0]) * (1 - u) + (c[2] - c[1]) * u;
  return (du % dv).length();
}

}  // namespace

SurfacePoint point_at(const Primitive& p, double u, double v) {
  if (p.shape == Primitive::Shape::sphere) {
    const double phi = 2 * kPi * u, theta = kPi * v;
    const Vec3d out(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
    return {p.sphere_center + out * std::abs(p.sphere_radius), Vec3f(p.sphere_radius < 0 ? -out : out)};
  }
  // The cross product of the diagonals is the normal of quads and of triangles.
  const Vec3d normal = (p.corners[2] - p.corners[0]) % (p.corners[3] - p.corners[1]);
  return {position_at(p.corners, u, v), Vec3f(normal.normalized())};
}

Imath::V2d uv_of(const Primitive& quad, const Vec3d& position) {
  const auto& c = quad.corners;
  const Vec3d along = c[1] - c[0], across = c[3] - c[0], normal = along % across, to = position - c[0];
  const double square = normal ^ normal;
  const Vec2f shape = quad_shape(c);
  const Vec2f at = inverse_bilinear(shape.x, shape.y, float(((to % across) ^ normal) / square),
                                    float(((along % to) ^ normal) / square));
  return {at.x, at.y};
}

PatchSampler::PatchSampler(const Primitive& primitive, const Patch& patch) : primitive_(primitive), patch_(patch) {
  if (primitive.shape == Primitive::Shape::sphere) {
    cos_top_ = std::cos(kPi * patch.v0);
    cos_bottom_ = std::cos(kPi * patch.v1);
    return;
  }
  if (!patch.triangles.empty()) {
    areas_.push_back(0);
    for (std::size_t k = 0; k < patch.triangles.size(); k += 3) {
      const Vec3d &o = patch.triangles[k], &a = patch.triangles[k + 1], &b = patch.triangles[k + 2];
      areas_.push_back(areas_.back() + ((a - o) % (b - o)).length());
    }
    return;
  }
  for (int k = 0; k < 4; ++k)
    density_[k] = area_density(primitive.corners, k % 2 ? patch.u1 : patch.u0, k / 2 ? patch.v1 : patch.v0);
}

/// x chooses the triangle and the angle in it, y the distance from its first corner.
Vec3d PatchSampler::in_triangles(double x, double y) const {
  const double area = x * areas_.back();
  const auto next = std::clamp<std::ptrdiff_t>(std::upper_bound(areas_.begin(), areas_.end(), area) - areas_.begin(), 1,
                                               std::ptrdiff_t(areas_.size()) - 1);
  const double below = areas_[next - 1], size = areas_[next] - below;
  const double turn = size > 0 ? std::min((area - below) / size, 1.0) : 0.5;
  const Vec3d* const corner = &patch_.triangles[std::size_t(3 * (next - 1))];
  const Vec3d &o = corner[0], &a = corner[1], &b = corner[2];
  return o + ((a - o) * (1 - turn) + (b - o) * turn) * std::sqrt(y);
}

SurfacePoint PatchSampler::operator()(float x, float y) const {
  if (!areas_.empty()) return {in_triangles(x, y), patch_.normal};
  const Imath::V2d at = uv(x, y);
  if (primitive_.shape == Primitive::Shape::sphere) return point_at(primitive_, at.x, at.y);
  return {position_at(primitive_.corners, at.x, at.y), patch_.normal};
}

Imath::V2d PatchSampler::uv(float x, float y) const {
  if (!areas_.empty()) return uv_of(primitive_, in_triangles(x, y));
  if (primitive_.shape == Primitive::Shape::sphere) {
    const double u = patch_.u0 + x * double(patch_.u1 - patch_.u0);
    const double cos_theta = cos_top_ + y * (cos_bottom_ - cos_top_);
    return {u, std::acos(std::clamp(cos_theta, -1.0, 1.0)) / kPi};
  }
  const double v = sample_linear(y, density_[0] + density_[1], density_[2] + density_[3]);
  const double u = sample_linear(x, density_[0] * (1 - v) + density_[2] * v, density_[1] * (1 - v) + density_[3] * v);
  return {patch_.u0 + u * (patch_.u1 - patch_.u0), patch_.v0 + v * (patch_.v1 - patch_.v0)};
}

Vec3f cosine_direction(float x, float y) {
  const float radius = std::sqrt(x);
  const float angle = float(2 * kPi) * y;
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(std::max(0.0f, 1.0f - x))};
}

void orthonormal_frame(const Vec3f& n, Vec3f& tangent, Vec3f& bitangent) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
  bitangent = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace patchlight

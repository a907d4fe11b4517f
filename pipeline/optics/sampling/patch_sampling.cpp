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

using Densities = std::array<double, 4>;  // area per du dv at corners 00, 10, 01, 11 of a patch

Densities densities(const std::array<Vec3d, 4>& c, double u0, double v0, double u1, double v1) {
  return {area_density(c, u0, v0), area_density(c, u1, v0), area_density(c, u0, v1), area_density(c, u1, v1)};
}

/// Maps the unit square to that of a quad's patch, uniformly in the patch's area.
Imath::V2d uniform_in_area(const Densities& d, double x, double y) {
  const double v = sample_linear(y, d[0] + d[1], d[2] + d[3]);
  return {sample_linear(x, d[0] * (1 - v) + d[2] * v, d[1] * (1 - v) + d[3] * v), v};
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

PatchSampler::PatchSampler(const std::vector<Primitive>& primitives, const Patch& patch)
    : primitive_(primitives[patch.primitive]), patch_(patch) {
  const Primitive& primitive = primitive_;
  if (patch.facets > 0) {
    areas_.push_back(0);
    for (std::int32_t k = 0; k < patch.facets; ++k)
      areas_.push_back(areas_.back() + area_density(primitives[patch.primitive + k].corners, 0.5, 0.5));
    return;
  }
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
  density_ = densities(primitive.corners, patch.u0, patch.v0, patch.u1, patch.v1);
}

std::pair<std::size_t, double> PatchSampler::part_at(double x) const {
  const double area = x * areas_.back();
  const auto next = std::clamp<std::ptrdiff_t>(std::upper_bound(areas_.begin(), areas_.end(), area) - areas_.begin(), 1,
                                               std::ptrdiff_t(areas_.size()) - 1);
  const double below = areas_[next - 1], size = areas_[next] - below;
  return {std::size_t(next - 1), size > 0 ? std::min((area - below) / size, 1.0) : 0.5};
}

/// x chooses the triangle and the angle in it, y the distance from its first corner.
Vec3d PatchSampler::in_triangles(double x, double y) const {
  const auto [triangle, turn] = part_at(x);
  const Vec3d* const corner = &patch_.triangles[3 * triangle];
  const Vec3d &o = corner[0], &a = corner[1], &b = corner[2];
  return o + ((a - o) * (1 - turn) + (b - o) * turn) * std::sqrt(y);
}

SurfacePoint PatchSampler::operator()(float x, float y) const {
  if (!patch_.triangles.empty()) return {in_triangles(x, y), patch_.normal};
  const auto [primitive, at] = place(x, y);
  const Primitive& of_place = (&primitive_)[primitive - patch_.primitive];
  if (patch_.facets > 0 || primitive_.shape == Primitive::Shape::sphere) return point_at(of_place, at.x, at.y);
  return {position_at(primitive_.corners, at.x, at.y), patch_.normal};
}

PatchSampler::Place PatchSampler::place(float x, float y) const {
  if (patch_.facets > 0) {
    const auto [facet, rest] = part_at(x);
    const Densities of_facet = densities((&primitive_)[facet].corners, 0, 0, 1, 1);
    return {patch_.primitive + std::int32_t(facet), uniform_in_area(of_facet, rest, y)};
  }
  const auto here = [&](const Imath::V2d& uv) { return Place{patch_.primitive, uv}; };
  if (!patch_.triangles.empty()) return here(uv_of(primitive_, in_triangles(x, y)));
  if (primitive_.shape == Primitive::Shape::sphere) {
    const double u = patch_.u0 + x * double(patch_.u1 - patch_.u0);
    const double cos_theta = cos_top_ + y * (cos_bottom_ - cos_top_);
    return here({u, std::acos(std::clamp(cos_theta, -1.0, 1.0)) / kPi});
  }
  const Imath::V2d at = uniform_in_area(density_, x, y);
  return here({patch_.u0 + at.x * (patch_.u1 - patch_.u0), patch_.v0 + at.y * (patch_.v1 - patch_.v0)});
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

#include "tracer/sampling/outlines.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace patchlight {

namespace {

constexpr double kCoplanarCosine = 1 - 1e-9;  // between the normals of coplanar primitives
constexpr int kSphereSegments = 64;           // line segments of a sphere's silhouette

}  // namespace

Outlines::Outlines(const PatchSet& scene, const SmoothEdges& smooth)
    : scene_(scene), normals_(scene.primitives.size(), Vec3d(0.0)), surfaces_(scene.primitives.size()) {
  std::iota(surfaces_.begin(), surfaces_.end(), 0);
  for (std::size_t i = 0; i < normals_.size(); ++i) {
    const Primitive& p = scene.primitives[i];
    if (p.shape == Primitive::Shape::quad)
      normals_[i] = ((p.corners[2] - p.corners[0]) % (p.corners[3] - p.corners[1])).normalized();
  }
  add_edges(smooth);
  for (std::size_t i = 0; i < surfaces_.size(); ++i) surfaces_[i] = find_root(std::int32_t(i));
}

void Outlines::add_edges(const SmoothEdges& smooth) {
  edges_.reserve(4 * scene_.primitives.size());
  for (std::int32_t i = 0; i < std::int32_t(scene_.primitives.size()); ++i) {
    const Primitive& p = scene_.primitives[i];
    if (p.shape != Primitive::Shape::quad || p.region) continue;
    for (int edge = 0; edge < 4; ++edge)
      if (!SmoothEdges::has_sides(p, edge) && !(p.is_triangle() && edge == 2)) edges_.push_back({i, -1, edge});
  }
  smooth.for_each_edge([this](std::span<const SmoothEdges::Side> sides) {
    const std::int32_t i = sides[0].primitive, other = sides.back().primitive;
    if (sides.size() != 2) {
      for (const SmoothEdges::Side& side : sides)
        if (!scene_.primitives[side.primitive].region) edges_.push_back({side.primitive, -1, side.edge});
      return;
    }
    surfaces_[find_root(i)] = find_root(other);
    if ((normals_[i] ^ normals_[other]) <= kCoplanarCosine) edges_.push_back({i, other, sides[0].edge});
  });
}

/// Representative of the smooth surface that primitive `i` belongs to.
std::int32_t Outlines::find_root(std::int32_t i) {
  while (surfaces_[i] != i) i = surfaces_[i] = surfaces_[surfaces_[i]];
  return i;
}

std::vector<float> Outlines::draw(const CameraRays& rays, int width, int height) const {
  OutlineCanvas canvas(rays, width, height);
  const Vec3d eye = rays.eye(), forward = rays.forward();
  const auto faces_camera = [&](std::int32_t i, const Vec3d& at) {
    return ((rays.perspective() ? at - eye : forward) ^ normals_[i]) < 0;
  };
  const auto draw_line = [&](const Vec3d& from, const Vec3d& to) {
    canvas.draw_line(rays.to_camera(from), rays.to_camera(to));
  };
  for (const Edge& edge : edges_) {
    const auto& corners = scene_.primitives[edge.primitive].corners;
    const Vec3d &from = corners[edge.edge], &to = corners[(edge.edge + 1) % 4];
    if (edge.other < 0 || faces_camera(edge.primitive, from) != faces_camera(edge.other, from)) draw_line(from, to);
  }
  for (const Primitive& p : scene_.primitives) {
    if (p.shape == Primitive::Shape::sphere) draw_sphere(p, canvas);
    if (!p.region) continue;
    for (const auto& [from, to] : p.region->edges)
      draw_line(position_at(p.corners, from.x, from.y), position_at(p.corners, to.x, to.y));
  }
  return canvas.depths();
}

void Outlines::draw_sphere(const Primitive& sphere, OutlineCanvas& canvas) const {
  Vec3d center = sphere.sphere_center, axis = canvas.rays.forward();
  double radius = std::abs(sphere.sphere_radius);
  if (canvas.rays.perspective()) {
    const Vec3d to = canvas.rays.eye() - center;
    const double part = radius * radius / to.length2();
    if (part >= 1) return;
    center += to * part;
    radius *= std::sqrt(1 - part);
    axis = to.normalized();
  }
  const Vec3d side = (std::abs(axis.y) < 0.9 ? axis % Vec3d(0, 1, 0) : axis % Vec3d(1, 0, 0)).normalized();
  const Vec3d up = axis % side;
  const auto at = [&](int k) {
    const double angle = 2 * kPi * k / kSphereSegments;
    return canvas.rays.to_camera(center + (side * std::cos(angle) + up * std::sin(angle)) * radius);
  };
  for (int k = 0; k < kSphereSegments; ++k) canvas.draw_line(at(k), at(k + 1));
}

}  // namespace patchlight

#include "tracer/sampling/outlines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace patchlight {

namespace {

constexpr double kCoplanarCosine = 1 - 1e-9;  // between the normals of coplanar primitives
constexpr double kNearClip = 1e-4;            // depth at which an edge is clipped, over its largest depth
constexpr int kSphereSegments = 64;           // line segments of a sphere's silhouette

}  // namespace

/// Depth buffer that edges are drawn into.
struct Outlines::Canvas {
  const CameraRays& rays;
  int width, height;
  std::vector<float> depths;

  /// Draws a line between two points in camera space.
  void draw_line(Vec3d a, Vec3d b) {
    if (a.z > b.z) std::swap(a, b);  // b is nearer
    if (!(a.z < 0)) return;
    const double nearest = rays.perspective() ? kNearClip * a.z : 0.0;
    if (b.z > nearest) b = a + (b - a) * ((nearest - a.z) / (b.z - a.z));
    const Imath::V2d p = rays.to_image(a), q = rays.to_image(b);
    // 1 / depth is linear along a line in the image; in parallel projection depth itself is.
    const double at_p = rays.perspective() ? -1 / a.z : -a.z, at_q = rays.perspective() ? -1 / b.z : -b.z;
    const bool horizontal = std::abs(q.x - p.x) >= std::abs(q.y - p.y);
    const auto along = [&](const Imath::V2d& v) { return horizontal ? v.x : v.y; };
    const auto across = [&](const Imath::V2d& v) { return horizontal ? v.y : v.x; };
    const double low = std::min(along(p), along(q)), high = std::max(along(p), along(q));
    const int steps = horizontal ? width : height, rows = horizontal ? height : width;
    if (!(high >= 0 && low < steps)) return;
    const double length = along(q) - along(p);
    for (int step = int(std::max(0.0, std::floor(low))); step < steps && step <= high; ++step) {
      const auto parameter = [&](double x) {
        return length != 0 ? std::clamp((x - along(p)) / length, 0.0, 1.0) : 0.0;
      };
      const double s = parameter(step), t = length != 0 ? parameter(step + 1) : 1.0;
      const double from = across(p) + (across(q) - across(p)) * s, to = across(p) + (across(q) - across(p)) * t;
      const double v = at_p + (at_q - at_p) * s, w = at_p + (at_q - at_p) * t;
      const auto depth = float(rays.perspective() ? 1 / std::max(v, w) : std::min(v, w));
      const double first = std::max(0.0, std::floor(std::min(from, to)));
      const double last = std::min(double(rows - 1), std::floor(std::max(from, to)));
      for (int row = int(std::min(first, double(rows))); row <= last; ++row) {
        float& nearest_edge =
            horizontal ? depths[std::size_t(row) * width + step] : depths[std::size_t(step) * width + row];
        nearest_edge = std::min(nearest_edge, depth);
      }
    }
  }
};

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
  Canvas canvas{rays, width, height,
                std::vector<float>(std::size_t(width) * height, std::numeric_limits<float>::infinity())};
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
  return std::move(canvas.depths);
}

void Outlines::draw_sphere(const Primitive& sphere, Canvas& canvas) const {
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

#include "pipeline/optics/intersect/ray_scene.h"

#include <ImathBox.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/intersect/rounding.h"
#include "pipeline/optics/intersect/surface_sizes.h"
#include "pipeline/optics/sampling/quad_shape.h"

namespace patchlight {

namespace {

constexpr float kMinOffset = 1e-20f;

std::array<Vec3d, 4> exact(const std::array<Vec3f, 4>& corners) {
  return {Vec3d(corners[0]), Vec3d(corners[1]), Vec3d(corners[2]), Vec3d(corners[3])};
}

Vec3d normal_of(const std::array<Vec3f, 4>& corners) {
  const auto [a, b, c, d] = exact(corners);
  return ((c - a) % (d - b)).normalized();
}

/// Bound of the distances, along the normal, of ray origins on a quad from the plane that is traced. With the unit
/// roundoff u, the largest coordinates M_k and the extents D_k of the quad: its corners are rounded by u M_k, which
/// moves its plane by up to 3 u M_k; origins are rounded by u M_k when they are computed, and again when they are
/// offset, and, where they are interpolated between corners, by 2 u M_k + 5 u D_k; the tracers round the height of an
/// origin over the plane by 5 u D_k. An axis-aligned quad thus has an offset from its own height alone, whatever its
/// extent.
/// At least kMinOffset, since Embree finds planes through the origin of a ray.
float quad_offset(const std::array<Vec3f, 4>& corners, const Vec3d& normal) {
  Vec3d size(0.0);
  Imath::Box3d box;
  for (const Vec3d& corner : exact(corners)) {
    for (int k = 0; k < 3; ++k) size[k] = std::max(size[k], std::abs(corner[k]));
    box.extendBy(corner);
  }
  const double error = kUnitRoundoff * (8 * absolute_dot(normal, size) + 10 * absolute_dot(normal, box.size()));
  return std::max(float(error), kMinOffset);
}

/// The same for a sphere: its centre and origins are rounded by 3 u (|centre_k| + radius), and the tracers round the
/// square of an origin's distance from the centre by 16 u radius^2, which is 8 u radius of the distance.
float sphere_offset(const Vec3d& center, double radius) {
  return float(kUnitRoundoff * (4 * center.length() + 16 * radius));
}

RayScene::Surfaces kind_of(const PatchSet& scene, const Primitive& primitive) {
  using Surfaces = RayScene::Surfaces;
  return primitive.intangible                ? Surfaces::intangible
         : lets_light_pass(scene, primitive) ? Surfaces::passable
                                             : Surfaces::tangible;
}

std::uint32_t active_lanes(const RayPacket& packet) {
  std::uint32_t active = 0;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) active |= std::uint32_t(packet.valid[lane] != 0) << lane;
  return active;
}

}  // namespace

RayScene::RayScene(const PatchSet& scene, Tracer tracer, Surfaces surfaces) : scene_(&scene) {
  const Imath::Box3d bounds = bounds_of(scene.primitives);
  origin_ = bounds.center();
  offsets_.resize(scene.primitives.size());
  const SurfaceSizes sizes(scene);
  mostly_fine_ = sizes.mostly_fine();
  if (tracer == Tracer::packets || (tracer == Tracer::fastest && sizes.suit_packets()))
    packet_tracer_.emplace();
  else
    embree_ = EmbreeTracer::create();
  const auto any_of_kind = [&](Surfaces kind, bool masked) {
    return std::ranges::any_of(
        scene.primitives, [&](const Primitive& p) { return (!masked || p.mask >= 0) && kind_of(scene, p) == kind; });
  };
  if (any_of_kind(surfaces, true)) masked_embree_ = EmbreeTracer::create();
  if (surfaces == Surfaces::tangible && any_of_kind(Surfaces::passable, false))
    passable_ = std::make_unique<const RayScene>(scene, tracer, Surfaces::passable);
  add_quads(scene, surfaces);
  add_spheres(scene, surfaces);
  if (packet_tracer_) packet_tracer_->build();
  if (embree_) embree_->build();
  if (masked_embree_) masked_embree_->build();
}

void RayScene::add_quads(const PatchSet& scene, Surfaces surfaces) {
  std::vector<std::array<Vec3f, 4>> corners, masked_corners;
  std::vector<Quad> masked;
  quads_.reserve(scene.primitives.size());
  if (!packet_tracer_) corners.reserve(scene.primitives.size());
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    const Primitive& p = scene.primitives[i];
    if (p.shape != Primitive::Shape::quad) continue;
    const std::array<Vec3f, 4> local = to_local(p.corners);
    const Vec3d normal = normal_of(local);
    offsets_[i] = quad_offset(local, normal);
    // Corners 1 and 3 from a plane through 0 and 2; half of it is the bilinear surface from two triangles.
    const auto height = float(std::abs(Vec3d(local[1] - local[0]) ^ normal));
    offsets_[i] += 0.5f * height;
    if (p.back >= 0 && p.back < std::int32_t(i)) {
      offsets_[i] = offsets_[p.back];
      continue;
    }
    if (kind_of(scene, p) != surfaces) continue;
    const auto add = [&](const std::array<Vec3f, 4>& traced, const Vec2f& shape, std::int32_t piece) {
      const bool plane = packet_tracer_ && packet_tracer_->add_quad(exact(traced), std::int32_t(quads_.size()));
      quads_.push_back({std::int32_t(i), p.back, shape.x, shape.y, Vec3f(normal), !plane, piece});
      if (!packet_tracer_) corners.push_back(traced);
      return plane;
    };
    const Vec2f shape = quad_shape(p.corners);
    if (p.region) {
      for (const auto& uv : p.region->pieces) {
        std::array<Vec3d, 4> of_piece;
        for (int k = 0; k < 4; ++k) of_piece[k] = position_at(p.corners, uv[k].x, uv[k].y);
        pieces_.push_back({Vec2f(uv[0]), Vec2f(uv[1] - uv[0]), Vec2f(uv[3] - uv[0])});
        add(to_local(of_piece), quad_shape(of_piece), std::int32_t(pieces_.size()) - 1);
      }
    } else if (p.mask >= 0) {
      masked.push_back({std::int32_t(i), p.back, shape.x, shape.y, Vec3f(normal), true});
      masked_corners.push_back(local);
    } else if (add(local, shape, -1)) {
      offsets_[i] += 0.5f * height;
    }
  }
  if (!corners.empty()) embree_->add_quads(corners);
  if (masked.empty()) return;
  masked_embree_->add_filtered_quads(masked_corners, unsigned(quads_.size()),
                                     [this](auto&&... hit) { return accepts_hit(hit...); });
  quads_.insert(quads_.end(), masked.begin(), masked.end());
}

void RayScene::add_spheres(const PatchSet& scene, Surfaces surfaces) {
  std::vector<std::array<float, 4>> spheres;
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    const Primitive& p = scene.primitives[i];
    if (p.shape != Primitive::Shape::sphere) continue;
    const Vec3f center = to_local(p.sphere_center);
    const float radius = float(std::abs(p.sphere_radius));
    offsets_[i] = sphere_offset(Vec3d(center), double(radius));
    if ((p.back >= 0 && p.back < std::int32_t(i)) || kind_of(scene, p) != surfaces) continue;
    if (packet_tracer_)
      packet_tracer_->add_sphere(Vec3d(center), double(radius), std::int32_t(spheres_.size()));
    else
      spheres.push_back({center.x, center.y, center.z, radius});
    const bool outside = p.sphere_radius > 0;
    spheres_.push_back({outside ? std::int32_t(i) : p.back, outside ? p.back : std::int32_t(i), center});
  }
  if (!spheres.empty()) embree_->add_spheres(spheres);
}

void RayScene::intersect(RayPacket& packet, bool coherent) const {
  if (packet_tracer_)
    packet_tracer_->intersect(packet.rays, active_lanes(packet));
  else
    embree_->intersect(packet.valid, packet.rays, coherent);
  if (masked_embree_) masked_embree_->intersect(packet.valid, packet.rays, coherent);
  if (!passable_) return;
  std::array<float, RayPacket::kSize> distances;
  std::copy_n(packet.rays.ray.tfar, RayPacket::kSize, distances.begin());
  passable_->intersect(packet, coherent);
  packet.passable = 0;
  for (int lane = 0; lane < RayPacket::kSize; ++lane)
    packet.passable |= std::uint32_t(packet.valid[lane] != 0 && packet.rays.ray.tfar[lane] < distances[lane]) << lane;
}

std::uint32_t RayScene::occluded(RayPacket& packet) const {
  const std::uint32_t active = active_lanes(packet);
  const std::uint32_t occluded_lanes =
      packet_tracer_ ? packet_tracer_->occluded(packet.rays.ray, active) : embree_->occluded(packet.rays.ray, active);
  return masked_embree_ ? occluded_lanes | masked_embree_->occluded(packet.rays.ray, active & ~occluded_lanes)
                        : occluded_lanes;
}

inline SurfaceHit RayScene::surface_hit(unsigned geometry, unsigned index, float s, float t, const Vec3f& origin,
                                        const Vec3f& direction, float distance) const {
  SurfaceHit result;
  result.t = distance;
  if (geometry == EmbreeTracer::kSpheres) {
    const Sphere& sphere = spheres_[index];
    const Vec3f out = origin + direction * distance - sphere.center;
    const bool from_outside = (out ^ direction) < 0;
    const std::int32_t side = from_outside ? sphere.outside : sphere.inside;
    result.front = side >= 0;
    result.primitive = side >= 0 ? side : (from_outside ? sphere.inside : sphere.outside);
    const Vec2f uv = sphere_uv(out);
    result.u = uv.x;
    result.v = uv.y;
    return result;
  }
  const Quad& quad = quads_[index];
  const bool from_front = (quad.normal ^ direction) < 0;
  result.front = from_front || quad.back >= 0;
  result.primitive = from_front || quad.back < 0 ? quad.front : quad.back;
  result.u = s;
  result.v = t;
  const bool parallelogram = quad.a == 1.0f && quad.b == 1.0f;
  if (!parallelogram && quad.two_triangles && s + t > 1.0f) {  // triangle (2,3,1)
    const float p = 1.0f - s, q = 1.0f - t;
    s = quad.a - p * quad.a + q * (1.0f - quad.a);
    t = quad.b + p * (1.0f - quad.b) - q * quad.b;
  }
  if (quad.piece >= 0) {
    const Piece& piece = pieces_[quad.piece];
    const Vec2f uv = piece.corner + piece.along * s + piece.across * t;
    result.u = std::clamp(uv.x, 0.0f, 1.0f);
    result.v = std::clamp(uv.y, 0.0f, 1.0f);
  } else if (!parallelogram) {
    const Vec2f uv = inverse_bilinear(quad.a, quad.b, s, t);
    result.u = uv.x;
    result.v = uv.y;
  } else {
    result.u = std::clamp(result.u, 0.0f, 1.0f);
    result.v = std::clamp(result.v, 0.0f, 1.0f);
    result.at_edge = result.u != s || result.v != t;
  }
  if (!from_front && quad.back >= 0) result.u = 1.0f - result.u;
  return result;
}

SurfaceHit RayScene::hit(const RayPacket& packet, int lane) const {
  const auto& h = packet.rays.hit;
  if (packet.valid[lane] == 0 || h.geomID[lane] == RTC_INVALID_GEOMETRY_ID) return {};
  const RayScene& hit_scene = passable_ && (packet.passable >> lane & 1u) ? *passable_ : *this;
  return hit_scene.surface_hit(h.geomID[lane], h.primID[lane], h.u[lane], h.v[lane], packet.origin(lane),
                               packet.direction(lane), packet.rays.ray.tfar[lane]);
}

/// Hit filter of masked quads: the alpha test.
bool RayScene::accepts_hit(unsigned quad, const Vec2f& at, const Vec3f& origin, const Vec3f& direction,
                           float distance) const {
  const SurfaceHit hit = surface_hit(EmbreeTracer::kQuads, quad, at.x, at.y, origin, direction, distance);
  return passes_alpha_test(*scene_, hit.primitive, hit.u, hit.v);
}

Vec2f sphere_uv(const Vec3f& direction) {
  const float turn = std::atan2(-direction.z, direction.x) * float(0.5 / kPi);
  const float u = turn < 0.0f ? turn + 1.0f : turn;
  const float horizontal = std::sqrt(direction.x * direction.x + direction.z * direction.z);
  return {std::min(u, 1.0f), std::atan2(horizontal, direction.y) * float(1.0 / kPi)};
}

}  // namespace patchlight

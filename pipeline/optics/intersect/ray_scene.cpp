#include "pipeline/optics/intersect/ray_scene.h"

#include <ImathBox.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/intersect/quad_shape.h"

namespace patchlight {

namespace {

// Intersection points of planes are good to about 8 units in the last place; of spheres, where two squares nearly
// cancel, to about 32.
constexpr float kPlaneOffset = 0x1p-20f;
constexpr float kSphereOffset = 0x1p-18f;

// How far surfaces reach beyond their edges, in the scene's size, so that no ray slips between neighbours.
constexpr double kOverlap = 0x1p-21;

static_assert(2 * RayScene::kFew <= 0xffff, "a leaf may hold all surfaces, and a bent quad is two");

float largest(const Vec3f& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

Imath::Box3d bounds_of(const PatchSet& scene) {
  Imath::Box3d bounds;
  for (const Primitive& p : scene.primitives) {
    if (p.shape == Primitive::Shape::quad) {
      for (const auto& corner : p.corners) bounds.extendBy(corner);
    } else {
      bounds.extendBy(p.sphere_center - Vec3d(std::abs(p.sphere_radius)));
      bounds.extendBy(p.sphere_center + Vec3d(std::abs(p.sphere_radius)));
    }
  }
  return bounds;
}

std::uint32_t wanted_lanes(const RayPacket& packet) {
  std::uint32_t wanted = 0;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) wanted |= std::uint32_t(packet.valid[lane] != 0) << lane;
  return wanted;
}

}  // namespace

void RayPacket::clear() {
  valid.fill(0);
}

void RayPacket::start() {
  auto& r = rays.ray;
  for (int lane = 0; lane < kSize; ++lane) {
    r.tnear[lane] = 0.0f;
    r.tfar[lane] = std::numeric_limits<float>::infinity();
    r.time[lane] = 0.0f;
    r.mask[lane] = ~0u;
    r.id[lane] = 0;
    r.flags[lane] = 0;
    rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    valid[lane] = -1;
  }
}

void RayPacket::set(int lane, const Vec3f& origin, const Vec3f& direction, float t_near) {
  auto& r = rays.ray;
  r.org_x[lane] = origin.x;
  r.org_y[lane] = origin.y;
  r.org_z[lane] = origin.z;
  r.dir_x[lane] = direction.x;
  r.dir_y[lane] = direction.y;
  r.dir_z[lane] = direction.z;
  r.tnear[lane] = t_near;
  r.tfar[lane] = std::numeric_limits<float>::infinity();
  r.time[lane] = 0.0f;
  r.mask[lane] = ~0u;
  r.id[lane] = 0;
  r.flags[lane] = 0;
  rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  valid[lane] = -1;
}

void RayPacket::set_shadow(int lane, const Vec3f& origin, const Vec3f& direction, float distance) {
  set(lane, origin, direction);
  rays.ray.tfar[lane] = distance;
}

RayScene::RayScene(const PatchSet& scene, std::size_t few) {
  const Imath::Box3d bounds = bounds_of(scene);
  origin_ = bounds.center();
  offsets_.resize(scene.primitives.size());
  const auto masked =
      std::count_if(scene.primitives.begin(), scene.primitives.end(), [](const Primitive& p) { return p.mask >= 0; });
  if (scene.primitives.size() - std::size_t(masked) <= few)
    few_.emplace();
  else
    many_ = EmbreeTracer::start();
  if (masked > 0) {
    masked_ = EmbreeTracer::start();
    patches_ = &scene;
  }
  add_quads(scene, largest(Vec3f(bounds.max - origin_)));
  add_spheres(scene);
  if (few_) few_->build();
  if (many_) many_->build();
  if (masked_) masked_->build();
}

void RayScene::add_quads(const PatchSet& scene, float extent) {
  std::vector<std::array<Vec3f, 4>> corners, masked_corners;
  std::vector<Quad> masked;
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    const Primitive& p = scene.primitives[i];
    if (p.shape != Primitive::Shape::quad) continue;
    std::array<Vec3f, 4> local;
    std::array<Vec3d, 4> exact;
    float size = 0;
    for (int k = 0; k < 4; ++k) {
      local[k] = to_local(p.corners[k]);
      exact[k] = Vec3d(local[k]);
      size = std::max(size, largest(local[k]));
    }
    offsets_[i] = std::max(size * kPlaneOffset, std::numeric_limits<float>::min());
    const Vec3d normal = ((exact[2] - exact[0]) % (exact[3] - exact[1])).normalized();
    const auto sag = float(std::abs((exact[0] - exact[1] + exact[2] - exact[3]) ^ normal) / 4);
    if (sag > offsets_[i]) offsets_[i] += sag;
    if (p.back >= 0 && p.back < std::int32_t(i)) continue;
    const Vec2f shape = quad_shape(p.corners);
    if (p.mask >= 0) {
      masked.push_back({std::int32_t(i), p.back, shape.x, shape.y, Vec3f(normal), true});
      masked_corners.push_back(local);
      continue;
    }
    const bool plane = few_ && few_->add_quad(exact, extent * kOverlap, std::int32_t(quads_.size()));
    quads_.push_back({std::int32_t(i), p.back, shape.x, shape.y, Vec3f(normal), !plane});
    if (!few_) corners.push_back(local);
  }
  if (!corners.empty()) many_->add_quads(corners);
  if (masked.empty()) return;
  masked_->add_filtered_quads(masked_corners, unsigned(quads_.size()),
                              [this](auto&&... hit) { return is_hit(hit...); });
  quads_.insert(quads_.end(), masked.begin(), masked.end());
}

void RayScene::add_spheres(const PatchSet& scene) {
  std::vector<std::array<float, 4>> balls;
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    const Primitive& p = scene.primitives[i];
    if (p.shape != Primitive::Shape::sphere) continue;
    const Vec3f center = to_local(p.sphere_center);
    const float radius = float(std::abs(p.sphere_radius));
    offsets_[i] = (largest(center) + radius) * kSphereOffset;
    if (p.back >= 0 && p.back < std::int32_t(i)) continue;
    if (few_)
      few_->add_sphere(Vec3d(center), double(radius), std::int32_t(spheres_.size()));
    else
      balls.push_back({center.x, center.y, center.z, radius});
    const bool outside = p.sphere_radius > 0;
    spheres_.push_back({outside ? std::int32_t(i) : p.back, outside ? p.back : std::int32_t(i), center});
  }
  if (!balls.empty()) many_->add_spheres(balls);
}

void RayScene::intersect(RayPacket& packet, bool coherent) const {
  if (few_)
    few_->intersect(packet.rays, wanted_lanes(packet));
  else
    many_->intersect(packet.valid, packet.rays, coherent);
  if (masked_) masked_->intersect(packet.valid, packet.rays, coherent);
}

std::uint32_t RayScene::occluded(RayPacket& packet) const {
  const std::uint32_t wanted = wanted_lanes(packet);
  const std::uint32_t blocked =
      few_ ? few_->occluded(packet.rays.ray, wanted) : many_->occluded(packet.rays.ray, wanted);
  return masked_ ? blocked | masked_->occluded(packet.rays.ray, wanted & ~blocked) : blocked;
}

inline SurfaceHit RayScene::hit_on(unsigned geometry, unsigned index, float s, float t, const Vec3f& origin,
                                   const Vec3f& direction, float distance) const {
  SurfaceHit result;
  result.t = distance;
  if (geometry == EmbreeTracer::kSpheres) {
    const Sphere& sphere = spheres_[index];
    const Vec3f out = origin + direction * distance - sphere.center;
    const bool outer = (out ^ direction) < 0;
    const std::int32_t seen = outer ? sphere.outside : sphere.inside;
    result.front = seen >= 0;
    result.primitive = seen >= 0 ? seen : (outer ? sphere.inside : sphere.outside);
    const Vec2f uv = sphere_uv(out);
    result.u = uv.x;
    result.v = uv.y;
    return result;
  }
  const Quad& quad = quads_[index];
  const bool outer = (quad.normal ^ direction) < 0;
  result.front = outer || quad.back >= 0;
  result.primitive = outer || quad.back < 0 ? quad.front : quad.back;
  result.u = s;
  result.v = t;
  if (quad.a != 1.0f || quad.b != 1.0f) {
    if (quad.two_triangles && s + t > 1.0f) {  // of the triangle (2,3,1)
      const float p = 1.0f - s, q = 1.0f - t;
      s = quad.a - p * quad.a + q * (1.0f - quad.a);
      t = quad.b + p * (1.0f - quad.b) - q * quad.b;
    }
    const Vec2f uv = inverse_bilinear(quad.a, quad.b, s, t);
    result.u = uv.x;
    result.v = uv.y;
  } else {
    result.u = std::clamp(result.u, 0.0f, 1.0f);
    result.v = std::clamp(result.v, 0.0f, 1.0f);
  }
  if (!outer && quad.back >= 0) result.u = 1.0f - result.u;
  return result;
}

SurfaceHit RayScene::hit(const RayPacket& packet, int lane) const {
  const auto& h = packet.rays.hit;
  if (packet.valid[lane] == 0 || h.geomID[lane] == RTC_INVALID_GEOMETRY_ID) return {};
  return hit_on(h.geomID[lane], h.primID[lane], h.u[lane], h.v[lane], packet.origin(lane), packet.direction(lane),
                packet.rays.ray.tfar[lane]);
}

/// Whether a masked quad is there where a ray comes to it.
bool RayScene::is_hit(unsigned quad, const Vec2f& at, const Vec3f& origin, const Vec3f& direction,
                      float distance) const {
  const SurfaceHit hit = hit_on(EmbreeTracer::kQuads, quad, at.x, at.y, origin, direction, distance);
  return passes_alpha_test(*patches_, hit.primitive, hit.u, hit.v);
}

Vec2f sphere_uv(const Vec3f& direction) {
  const float turn = std::atan2(-direction.z, direction.x) * float(0.5 / kPi);
  const float u = turn < 0.0f ? turn + 1.0f : turn;
  const float across = std::sqrt(direction.x * direction.x + direction.z * direction.z);
  return {std::min(u, 1.0f), std::atan2(across, direction.y) * float(1.0 / kPi)};
}

}  // namespace patchlight

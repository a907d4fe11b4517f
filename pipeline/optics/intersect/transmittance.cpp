#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/surface/glass.h"
#include "pipeline/optics/surface/mirror.h"
#include "pipeline/optics/surface/texture_lookup.h"

namespace patchlight {

namespace {

constexpr int kMostSurfaces = 256;  // that light passes along a ray
constexpr float kBlack = 1e-4f;

/// A body of glass that a ray has entered.
struct Entry : GlassEntry {
  float distance = 0.0f;  ///< Along the ray, m.
};

/// What a surface lets pass straight. `entry`: the body that the ray is in.
Color passed_straight(const PatchSet& scene, const SurfaceHit& hit, const Vec3f& direction, Entry& entry) {
  const Primitive& primitive = scene.primitives[hit.primitive];
  const Material& material = scene.materials[primitive.material];
  const Transmission& glass = material.transmission;
  const float alpha = primitive.mask >= 0 ? std::min(alpha_at(scene, hit.primitive, hit.u, hit.v), 1.0f) : 1.0f;
  const Color open(1.0f - alpha);
  if (!glass.exists() || material.roughness >= kMirrorRoughness) return open;
  const Vec3f normal = point_at(primitive, hit.u, hit.v).normal;
  const float cosine = std::min(std::abs(direction ^ normal), 1.0f);
  const Color reflectance = specular_properties_at(scene, hit.primitive, hit.u, hit.v).reflectance(cosine);
  Color passed = (Color(1.0f) - reflectance) * glass.tint * glass.part;
  if (is_colored(scene, hit.primitive)) passed *= base_color(scene, hit.primitive, hit.u, hit.v);
  if (glass.solid && hit.front) {
    entry = {{hit.primitive, normal}, hit.t};
  } else if (glass.solid && !hit.front) {
    const float length = hit.t - entry.distance;
    if (entry.primitive >= 0 && !is_plate(scene, entry, normal, length * cosine)) return open;
    const Color once = unabsorbed(glass, length * cosine / inner_cosine(glass.ior, cosine));
    for (int k = 0; k < 3; ++k) {
      const float between = reflectance[k] * once[k];  // of both faces, after which light is where it was
      passed[k] *= once[k] / std::max(1.0f - between * between, 1e-6f);
    }
    entry = {};
  }
  return open + passed * alpha;
}

}  // namespace

Color straight_transmittance(const PatchSet& scene, const SurfaceHit& hit, const Vec3f& direction) {
  Entry entry;
  return passed_straight(scene, hit, direction, entry);
}

RayScene::Transmittances RayScene::transmittances(const RayPacket& packet, std::uint32_t lanes) const {
  Transmittances result;
  result.fill(Color(1.0f));
  if (!passable_ || lanes == 0) return result;
  RayPacket rays = packet;
  std::array<Entry, RayPacket::kSize> entries{};
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    rays.valid[lane] = -int(lanes >> lane & 1u);
    rays.rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  }
  bool any = true;
  for (int surfaces = 0; any && surfaces < kMostSurfaces; ++surfaces) {
    any = false;
    passable_->intersect(rays, false);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (rays.valid[lane] == 0) continue;
      const SurfaceHit hit = passable_->hit(rays, lane);
      rays.valid[lane] = 0;
      if (hit.primitive < 0) continue;
      Color& left = result[lane];
      left *= passed_straight(*scene_, hit, rays.direction(lane), entries[lane]);
      if (std::max({left.x, left.y, left.z}) < kBlack) {
        left = Color(0.0f);
        continue;
      }
      auto& ray = rays.rays.ray;
      ray.tnear[lane] = std::nextafter(hit.t + offset(hit.primitive), std::numeric_limits<float>::infinity());
      ray.tfar[lane] = packet.rays.ray.tfar[lane];
      rays.rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      rays.valid[lane] = -1;
      any = true;
    }
  }
  return result;
}

}  // namespace patchlight

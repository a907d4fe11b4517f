#include "tracer/light/passed_lamps.h"

#include "tracer/sampling/unseen.h"

namespace patchlight {

PassedLamps::PassedLamps(const PatchSet& scene, const SolvedSurfaces& surfaces, const LightMixes& mixes,
                         const GlossyLights* glossy_lights)
    : scene_(scene),
      lamps_(scene, RayScene::Tracer::fastest, RayScene::Surfaces::intangible),
      surfaces_(surfaces),
      mixes_(mixes),
      glossy_lights_(glossy_lights) {}

void PassedLamps::add(const RayPacket& packet, std::array<CameraPath, RayPacket::kSize>& paths, PathSums& sums) const {
  RayPacket rays = packet;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    if (paths[lane].central) rays.valid[lane] = 0;
    rays.rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  }
  for (bool active = true; active;) {
    active = false;
    lamps_.intersect(rays, false);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      if (rays.valid[lane] == 0) continue;
      const SurfaceHit hit = lamps_.hit(rays, lane);
      if (hit.primitive < 0) {
        rays.valid[lane] = 0;
        continue;
      }
      active = true;
      CameraPath& path = paths[lane];
      if (hit.front && !(path.is_direct() && is_unseen(scene_, hit.primitive)))
        add_emission(hit, rays.direction(lane), lane, path, sums);
      auto& ray = rays.rays.ray;
      ray.tnear[lane] = hit.t + lamps_.offset(hit.primitive);
      ray.tfar[lane] = packet.rays.ray.tfar[lane];
      rays.rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    }
  }
}

void PassedLamps::add_emission(const SurfaceHit& hit, const Vec3f& direction, int lane, CameraPath& path,
                               PathSums& sums) const {
  SolvedSurfaces::Colors colors = surfaces_.colors(hit);
  if (path.pdf > 0)
    colors.emission *=
        glossy_lights_->hit_weight(sums.glossy_rays->vertices[lane], direction, path.pdf, colors.patch, path.mirror);
  const auto radiance = [&](std::size_t mix) { return path.throughput * surfaces_.emission(colors, mix) / float(kPi); };
  sums.pixels[path.pixel] += radiance(0);
  path.features.light += radiance(mixes_.unscaled) * path.parts;
  if (!sums.layers) return;
  if (sums.layers->has_light()) sums.layers->add_emission(path.pixel, path.seen_by, radiance(0));
  for (std::size_t g = 0; g < sums.layers->group_count(); ++g)
    sums.layers->add_to_group(g, path.pixel, radiance(mixes_.first_group + g));
}

}  // namespace patchlight

#include <algorithm>
#include <cmath>

#include "tracer/light/path_tracer.h"

namespace patchlight {

namespace {

/// Seven levels for each channel. The points of a pixel on one surface share light, and those of a blurred pixel lie
/// far apart: so that light is not mixed with the reflectance at other places, only points of similar reflectance share
/// it.
std::int32_t brightness_levels(const Color& reflected) {
  std::int32_t levels = 0;
  for (int k = 0; k < 3; ++k) levels = 8 * levels + int(6.5f * std::sqrt(std::clamp(reflected[k], 0.0f, 1.0f)));
  return levels;
}

}  // namespace

/// Adds the emission of a side, and what it sends out of the light of the solution. Light of sampled emitters is to be
/// added at its points.
void PathTracer::add_diffuse_light(const DiffuseSide& side, int lane, const CameraRays& camera, Path& path,
                                   PathSums& sums) const {
  const auto& [hit, colors, position, normal, smooth, flat] = side;
  const DisplayLookup::Blend blend = surfaces_.blend(hit, colors.patch);
  const bool looked_up = path.faint && direct_;
  const auto radiance = [&](std::size_t mix) {
    const Color irradiance =
        looked_up ? surfaces_.total_irradiance(hit, blend, mix) : surfaces_.irradiance(hit, blend, mix);
    return path.throughput * (surfaces_.emission(colors, mix) + colors.reflectance * irradiance) / float(kPi);
  };
  const Color contribution =
      gather_ && !looked_up ? path.throughput * surfaces_.emission(colors) / float(kPi) : radiance(0);
  sums.pixels[path.pixel] += contribution;
  if (sums.layers) add_layers(hit, colors, blend, looked_up, path, *sums.layers);
  const bool is_same = mixes_.unscaled == 0 && (!gather_ || looked_up);
  path.features.light += (is_same ? contribution : radiance(mixes_.unscaled)) * path.parts;
  const Color reflected = path.throughput * colors.reflectance;
  if (!path.faint) path.features.reflectance += reflected;
  if (!direct_ || looked_up || !(max_component(colors.reflectance) > 0)) return;
  const std::int32_t surface = outlines_.surface(hit.primitive);
  sums.points.push_back({path.pixel, camera.has_lens() ? combined_hash(surface, brightness_levels(reflected)) : surface,
                         hit.primitive, path.seen_by, path.scattered, position, normal, reflected / float(kPi),
                         normal == smooth ? Vec3f(0.0f) : smooth});
  if (gather_) sums.gather.push_back({sums.points.back(), flat, path.sample, std::uint32_t(path.bounces)});
  if (!normals_.is_flat(hit.primitive)) lift_point(hit, lane, sums);
}

void PathTracer::add_layers(const SurfaceHit& hit, const SolvedSurfaces::Colors& colors,
                            const DisplayLookup::Blend& blend, bool looked_up, const Path& path,
                            LayerSums& layers) const {
  const Color factor = path.throughput / float(kPi);
  const Color reflected = factor * colors.reflectance;
  const bool has_irradiance = looked_up || !gather_;
  const auto total = [&](std::size_t mix) { return surfaces_.total_irradiance(hit, blend, mix); };
  if (layers.has_light()) layers.add_emission(path.pixel, path.seen_by, factor * surfaces_.emission(colors));
  if (layers.has_light() && has_irradiance) {
    const Color irradiance = surfaces_.irradiance(hit, blend), gathered = surfaces_.direct_part(hit, irradiance);
    const Color direct = looked_up ? gathered + (total(0) - irradiance) : gathered;
    layers.add_direct(path.pixel, path.seen_by, reflected * direct);
    layers.add_indirect(path.pixel, path.seen_by, reflected * (irradiance - gathered));
  }
  for (std::size_t g = 0; g < layers.group_count(); ++g) {
    const std::size_t mix = mixes_.first_group + g;
    layers.add_to_group(g, path.pixel, factor * surfaces_.emission(colors, mix));
    if (has_irradiance)
      layers.add_to_group(g, path.pixel, reflected * (looked_up ? total(mix) : surfaces_.irradiance(hit, blend, mix)));
  }
}

/// Prepares the last shading point to be moved.
void PathTracer::lift_point(const SurfaceHit& hit, int lane, PathSums& sums) const {
  const Vec3d& from = sums.points.back().position;
  const Vec3d to = normals_.on_smooth_surface(hit.primitive, hit.u, hit.v, from);
  const auto distance = float((to - from).length());
  if (distance <= ray_scene_.offset(hit.primitive)) return;
  LiftedPoints& lifted = sums.lifted ? *sums.lifted : sums.lifted.emplace();
  if (lifted.packet.valid[lane] != 0) return;  // of both sides of a surface, one is lifted
  lifted.pending = true;
  lifted.points[lane] = sums.points.size() - 1;
  lifted.positions[lane] = to;
  lifted.packet.set_shadow(lane, ray_scene_.to_local(from), Vec3f(to - from) / distance, distance);
}

void PathTracer::move_lifted_points(PathSums& sums) const {
  LiftedPoints& lifted = *sums.lifted;
  const std::uint32_t blocked = ray_scene_.occluded(lifted.packet);
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    if (lifted.packet.valid[lane] == 0) continue;
    lifted.packet.valid[lane] = 0;
    if (!(blocked >> lane & 1u)) sums.points[lifted.points[lane]].position = lifted.positions[lane];
  }
  lifted.pending = false;
}

}  // namespace patchlight

#include "pipeline/optics/sampling/random.h"
#include "tracer/light/path_tracer.h"
#include "tracer/sampling/pixel_samples.h"

namespace patchlight {

void PathTracer::sample_glossy_light(const SpecularProperties& specular, std::uint64_t seed, int lane, const Path& path,
                                     GlossyShadowRays& rays) const {
  const Vec2f at = pixel_sample(shuffled(path.sample, std::uint32_t(hash64(seed))), seed);
  const std::uint64_t choice_seed = hash64(seed);
  const float choice = pixel_sample(shuffled(path.sample, std::uint32_t(hash64(choice_seed))), choice_seed).x;
  const GlossyLights::Sample sample = glossy_lights_->sample(rays.vertices[lane], choice, at);
  if (sample.weight <= 0) return;
  rays.pending = true;
  rays.samples[lane] = sample;
  const float cosine = (sample.direction - rays.vertices[lane].direction).length() / 2;  // to the mirroring facet
  rays.throughputs[lane] = path.throughput * specular.reflectance(cosine);
  rays.packet.set_shadow(lane, ray_scene_.to_local(rays.vertices[lane].position), sample.direction, sample.distance);
}

/// Casts the pending shadow rays and adds the light of each unoccluded ray.
void PathTracer::add_glossy_light(std::array<Path, RayPacket::kSize>& paths, PathSums& sums) const {
  GlossyShadowRays& rays = *sums.glossy_rays;
  std::uint32_t visible = pass_shadow_rays(rays.packet, rays.throughputs);
  RayPacket behind_mirrors;
  behind_mirrors.clear();
  std::uint32_t reflected = 0;
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    rays.packet.valid[lane] = 0;
    const GlossyLights::Sample::Reflected& way = rays.samples[lane].reflected;
    if (!(visible >> lane & 1u) || way.distance <= 0) continue;
    reflected |= 1u << lane;
    behind_mirrors.set_shadow(lane, ray_scene_.to_local(way.position), way.direction, way.distance);
  }
  if (reflected != 0) visible &= ~reflected | pass_shadow_rays(behind_mirrors, rays.throughputs);
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    if (!(visible >> lane & 1u)) continue;
    const GlossyLights::Sample& sample = rays.samples[lane];
    const std::uint32_t pixel = paths[lane].pixel;
    const Color unscaled = rays.throughputs[lane] * sample.exitance * (sample.weight / float(kPi));
    const Color light = unscaled * mixes_.all[0][sample.group];
    sums.pixels[pixel] += light;
    if (!sums.layers) continue;
    if (sums.layers->has_light()) sums.layers->add_emission(pixel, paths[lane].seen_by, light);
    if (sums.layers->has_groups()) sums.layers->add_to_group(std::size_t(sample.group), pixel, unscaled);
  }
  rays.pending = false;
}

/// Casts shadow rays: the lanes that nothing stops, a bit each. Multiplies `light` by what they pass.
std::uint32_t PathTracer::pass_shadow_rays(RayPacket& packet, std::span<Color> light) const {
  std::uint32_t visible = ~ray_scene_.occluded(packet);
  for (int lane = 0; lane < RayPacket::kSize; ++lane)
    if (packet.valid[lane] == 0) visible &= ~(1u << lane);
  const RayScene::Transmittances passed = ray_scene_.transmittances(packet, visible);
  for (int lane = 0; lane < RayPacket::kSize; ++lane)
    if (visible >> lane & 1u) light[lane] *= passed[lane];
  return visible;
}

}  // namespace patchlight

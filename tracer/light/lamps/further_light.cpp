#include "tracer/light/lamps/further_light.h"

#include <algorithm>

#include "pipeline/optics/sampling/sobol.h"
#include "tracer/light/lamps/lamp_samples.h"

namespace patchlight {

namespace {

constexpr double kMaxBlur = 0.2;  // of importance, for choices that clusters share
constexpr double kFar = 10.0;     // distance in radii of an emitter that needs no closed form

float channel_sum(const Color& c) {
  return c.x + c.y + c.z;
}

/// Whether all parts of an emitter emit the same.
bool is_uniform(const PatchSet& scene, const Emitter& emitter) {
  if (scene.primitives[emitter.primitive].mask >= 0) return false;
  const auto first = scene.patches.begin() + emitter.first_patch;
  return std::all_of(first, first + emitter.patches,
                     [&](const Patch& patch) { return patch.emission == first->emission; });
}

/// further_emitters(), with an emitter for each patch of a quad that has a picture.
std::vector<Emitter> divided_emitters(const PatchSet& scene) {
  std::vector<Emitter> emitters;
  for (const Emitter& whole : further_emitters(scene)) {
    const bool is_quad = scene.primitives[whole.primitive].shape == Primitive::Shape::quad;
    if (!is_quad || is_uniform(scene, whole)) {
      emitters.push_back(whole);
      continue;
    }
    for (std::int32_t i = whole.first_patch; i < whole.first_patch + whole.patches; ++i)
      emitters.push_back({whole.primitive, i, 1, scene.patches[i].area});
  }
  return emitters;
}

/// The largest exitance of each emitter's patches, W/m2, sum of channels.
std::vector<float> strengths(const PatchSet& scene, const std::vector<Emitter>& emitters) {
  std::vector<float> result;
  for (const Emitter& emitter : emitters) {
    float& largest = result.emplace_back(0.0f);
    for (std::int32_t i = emitter.first_patch; i < emitter.first_patch + emitter.patches; ++i)
      largest = std::max(largest, channel_sum(scene.patches[i].emission));
  }
  return result;
}

}  // namespace

/// An emitter that was chosen for a cluster.
struct FurtherLight::Chosen {
  std::int32_t emitter = 0;
  int rays = 0;
  float weight = 0.0f;  ///< Of each ray: the inverse of the probability of the emitter.
};

FurtherLight::FurtherLight(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& settings)
    : FurtherLight(scene, ray_scene, settings, divided_emitters(scene)) {}

FurtherLight::FurtherLight(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& settings,
                           const std::vector<Emitter>& emitters)
    : scene_(scene),
      ray_scene_(ray_scene),
      lights_(scene, ray_scene, emitters, strengths(scene, emitters)),
      settings_(settings) {
  for (const Emitter& emitter : lights_.emitters())
    lamps_.push_back({emitter.primitive, scene.primitives[emitter.primitive].light_group, is_uniform(scene, emitter),
                      scene.patches[emitter.first_patch].emission});
  for (const Lamp& lamp : lamps_) off_ = off_ && settings_[lamp.group] == Color(0.0f);
}

Color FurtherLight::Samples::light(std::size_t group, bool mostly_visible) const {
  if (count == 0) return Color(0.0f);
  const Sums& sums = by_group_[group];
  return (mostly_visible ? sums.whole - sums.missed : sums.seen) / float(count);
}

float FurtherLight::Samples::brightness() const {
  float sum = 0;
  for (std::size_t g = 0; g < by_group_.size(); ++g) sum += channel_sum(light(g, visibility.mostly_visible()));
  return sum;
}

FurtherLight::Choices FurtherLight::choose(const LightTree::Receiver& receiver, int count, std::uint64_t seed) const {
  LightTree::Cut cut(lights_.tree(), receiver);
  return cut.blur() < kMaxBlur ? cut.choose(count, uniform01(seed)) : Choices{};
}

void FurtherLight::sample(const ShadingCluster& cluster, const Choices& choices, int count, std::uint64_t seed,
                          Samples& samples) const {
  samples.by_group_.resize(groups());
  samples.count += count;
  std::vector<Chosen> chosen;
  const auto choose = [&](const LightTree::Choice& choice) {
    if (choice.probability <= 0) return;
    if (!chosen.empty() && chosen.back().emitter == choice.emitter)
      ++chosen.back().rays;
    else
      chosen.push_back({choice.emitter, 1, float(1 / choice.probability)});
  };
  if (choices.size() >= std::size_t(count)) {
    const std::size_t step = choices.size() / std::size_t(count);
    for (std::size_t k = hash64(seed) % step; k < choices.size(); k += step) choose(choices[k]);
  } else {
    LightTree::Cut cut(lights_.tree(),
                       {cluster.center, cluster.radius, cluster.flat ? Vec3d(cluster.normal) : Vec3d(0.0)});
    for (const LightTree::Choice& choice : cut.choose(count, uniform01(seed))) choose(choice);
  }
  cast(cluster, chosen, seed, samples);
}

Color FurtherLight::exitance(std::int32_t emitter, const Vec3d& start, const DirectLight::Sample& ray) const {
  const Lamp& lamp = lamps_[emitter];
  if (lamp.uniform) return lamp.exitance;
  const std::int32_t patch = lights_.patch_at(emitter, start, ray);
  return patch < 0 ? Color(0.0f) : scene_.patches[patch].emission;
}

void FurtherLight::cast(const ShadingCluster& cluster, std::span<const Chosen> chosen, std::uint64_t seed,
                        Samples& samples) const {
  const PointPairs pairs(seed);
  std::uint32_t pair = 0;
  RayPacket packet;
  packet.clear();
  struct Target {
    Samples::Sums* sums;
    Color light;
  };
  std::array<Target, RayPacket::kSize> targets;
  int lane = 0;
  const auto cast_packet = [&] {
    const std::uint32_t visible = ~ray_scene_.occluded(packet) & ((1u << lane) - 1);
    const RayScene::Transmittances passed = ray_scene_.transmittances(packet, visible);
    for (int k = 0; k < lane; ++k) {
      const bool hidden = (visible >> k & 1u) == 0;
      const Color seen = hidden ? Color(0.0f) : targets[k].light * passed[k];
      targets[k].sums->seen += seen;
      targets[k].sums->missed += targets[k].light - seen;
      ++(hidden ? samples.visibility.hidden : samples.visibility.visible);
    }
    packet.clear();
    lane = 0;
  };
  for (const Chosen& one : chosen) {
    const Lamp& lamp = lamps_[one.emitter];
    if (lamp.primitive == cluster.primitive) continue;
    const DirectLight& light = lights_.light(one.emitter);
    Samples::Sums& sums = samples.by_group_[lamp.group];
    const float weight = one.weight * float(cluster.terminator(light));
    // The weight of a single ray to a far emitter is hardly less exact.
    const bool closed = lamp.uniform && (one.rays > 1 || light.distance(cluster.center) < kFar * light.radius());
    if (closed) {
      const double factor = cluster.form_factor(light, lights_.emitters()[one.emitter]);
      sums.whole += lamp.exitance * (float(factor) * weight * float(one.rays));
    }
    for (int k = 0; k < one.rays; ++k) {
      const auto [at, to] = pairs(pair++);
      const ShadingPoint& point = cluster.points[std::size_t(at.x * float(cluster.points.size()))];
      const DirectLight::Sample ray = light.view(point.position, point.normal, kFarLamp).sample(to.x, to.y);
      if (ray.weight <= 0) continue;
      const Color part = exitance(one.emitter, point.position, ray) * (ray.weight * weight);
      if (part == Color(0.0f)) continue;
      if (!closed) sums.whole += part;
      packet.set_shadow(lane, ray_scene_.to_local(point.position), ray.direction, ray.distance);
      targets[lane] = {&sums, part};
      if (++lane == RayPacket::kSize) cast_packet();
    }
  }
  if (lane > 0) cast_packet();
}

}  // namespace patchlight

#include "solver/direct/light_samples.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <array>
#include <utility>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/sampling/sobol.h"
#include "pipeline/stage/progress.h"
#include "solver/direct/direct_factors.h"

namespace patchlight {

namespace {

constexpr int kRowsPerTask = 64;

/// The sphere around a receiver, and its normal if it is a plane.
LightTree::Receiver bounds_of(const PatchSet& scene, const Patch& patch) {
  const Primitive& primitive = scene.primitives[patch.primitive];
  LightTree::Receiver receiver{patch.center, 0.0, Vec3d(patch.normal)};
  if (patch.facets > 0) {
    receiver.normal = Vec3d(0.0);
    for (std::int32_t i = patch.primitive; i < patch.primitive + patch.facets; ++i)
      for (const Vec3d& corner : scene.primitives[i].corners)
        receiver.radius = std::max(receiver.radius, (corner - patch.center).length());
    return receiver;
  }
  for (int k = 0; k < 4; ++k) {
    const SurfacePoint corner = point_at(primitive, k % 2 ? patch.u1 : patch.u0, k / 2 ? patch.v1 : patch.v0);
    receiver.radius = std::max(receiver.radius, (corner.position - patch.center).length());
  }
  if (primitive.shape == Primitive::Shape::sphere && receiver.radius > 0) receiver.normal = Vec3d(0.0);
  return receiver;
}

}  // namespace

/// Entries of a task's rows.
struct LightSampler::Entries {
  std::vector<std::pair<std::int32_t, float>> patches;  ///< And weights.
  std::vector<std::size_t> ends;                        ///< Of each segment.
  std::int64_t cast = 0;

  /// Ends a segment: adds up the weights of each patch.
  void end_segment() {
    const auto first = patches.begin() + std::ptrdiff_t(ends.empty() ? 0 : ends.back());
    std::stable_sort(first, patches.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    auto last = first;
    for (auto entry = first; entry != patches.end(); ++entry) {
      if (last != first && std::prev(last)->first == entry->first)
        std::prev(last)->second += entry->second;
      else
        *last++ = *entry;
    }
    patches.erase(last, patches.end());
    ends.push_back(patches.size());
  }
};

LightSampler::LightSampler(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Emitter>& emitters,
                           std::uint64_t seed)
    : scene_(scene), ray_scene_(ray_scene), lights_(scene, ray_scene, emitters), seed_(hash64(~seed)) {}

LightRows LightSampler::sample(std::span<const Patch> receivers, const VisibleDensities& densities, int rays,
                               std::int64_t& cast) const {
  LightRows rows;
  if (lights_.empty()) return rows;
  const int count = int(receivers.size()), tasks = (count + kRowsPerTask - 1) / kRowsPerTask;
  std::vector<Entries> all(tasks);
  tbb::parallel_for(0, tasks, [&](int task) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
    for (int row = task * kRowsPerTask; row < std::min((task + 1) * kRowsPerTask, count); ++row) {
      LightTree::Cut cut(lights_.tree(), bounds_of(scene_, receivers[row]));
      for (int set = 0; set < 2; ++set) {
        const std::uint64_t random = hash64(seed_ ^ hash64(2 * std::uint64_t(row) + std::uint64_t(set)));
        cast_rays(receivers[row], densities.find(row), cut.choose(rays, uniform01(random)), random, all[task]);
        all[task].end_segment();
      }
    }
  });
  Progress::check_interrupted();
  rows.starts.push_back(0);
  for (const Entries& entries : all) {
    const std::uint64_t before = rows.patches.size();
    for (const auto& [patch, weight] : entries.patches) {
      rows.patches.push_back(patch);
      rows.weights.push_back(weight);
    }
    for (const std::size_t end : entries.ends) rows.starts.push_back(before + end);
    cast += entries.cast;
  }
  return rows;
}

void LightSampler::cast_rays(const Patch& receiver, const VisibleDensity* density,
                             const std::vector<LightTree::Choice>& choices, std::uint64_t random,
                             Entries& entries) const {
  const Primitive& primitive = scene_.primitives[receiver.primitive];
  const PatchSampler sampler(scene_.primitives, receiver);
  const double offset = ray_scene_.offset(receiver.primitive);
  const PointPairs pairs(random);
  RayPacket packet;
  packet.clear();
  std::array<std::pair<std::int32_t, float>, RayPacket::kSize> targets;  // patches and weights
  int lane = 0;
  const auto cast_packet = [&] {
    if (lane == 0) return;
    const std::uint32_t visible = ~ray_scene_.occluded(packet) & ((1u << lane) - 1);
    const RayScene::Transmittances passed = ray_scene_.transmittances(packet, visible);
    for (int k = 0; k < lane; ++k) {
      if (!(visible >> k & 1u)) continue;
      entries.patches.push_back(targets[k]);
      entries.patches.back().second *= (passed[k].x + passed[k].y + passed[k].z) / 3;
    }
    entries.cast += lane;
    packet.clear();
    lane = 0;
  };
  for (std::size_t k = 0; k < choices.size(); ++k) {
    const auto& [index, probability] = choices[k];
    if (probability <= 0 || lights_.emitters()[index].primitive == receiver.primitive) continue;
    auto [at, to] = pairs(std::uint32_t(k));
    if (density) at = (*density)(at);
    SurfacePoint point = sampler(at.x, at.y);
    if (primitive.shape == Primitive::Shape::quad && receiver.facets == 0) point.normal = receiver.normal;
    const Vec3d start = point.position + Vec3d(point.normal) * offset;
    const DirectLight::Sample sample =
        lights_.light(index).view(start, point.normal, kAreaSamplingDistance).sample(to.x, to.y);
    if (sample.weight <= 0) continue;
    const std::int32_t patch = lights_.patch_at(index, start, sample);
    if (patch < 0) continue;
    packet.set_shadow(lane, ray_scene_.to_local(start), sample.direction, sample.distance);
    targets[lane] = {patch, float(double(sample.weight) / (probability * double(choices.size())))};
    if (++lane == RayPacket::kSize) cast_packet();
  }
  cast_packet();
}

int light_rays(int rays) {
  return std::max(32, rays / 4);
}

std::int64_t emitters_id(const std::vector<Emitter>& emitters) {
  std::uint64_t id = 0;
  for (const Emitter& emitter : emitters) id = hash64(id ^ hash64(std::uint64_t(emitter.first_patch) + 1));
  return emitters.empty() ? 0 : std::max<std::int64_t>(std::int64_t(id >> 1), 1);
}

}  // namespace patchlight

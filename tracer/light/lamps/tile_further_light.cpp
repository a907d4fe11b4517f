#include "tracer/light/lamps/tile_further_light.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>

#include "tracer/light/lamps/lamp_samples.h"

namespace patchlight {

namespace {

constexpr int kProbes = 16;             // of a cluster
constexpr int kMaxOpenChoices = 128;    // where all probes around reach their emitters
constexpr float kNoise = 0.013f;        // standard deviation of a cluster's light that such choices leave
constexpr int kSharedChoices = 512;     // of clusters of one normal in a block of pixels
constexpr std::size_t kMinShared = 6;   // clusters that share choices
constexpr int kBlock = 4;               // pixels along a block's edge
constexpr double kMargin = 1.25;        // of the sphere around a block's clusters, for further points in its pixels
constexpr float kMinSharpRatio = 0.4f;  // of the light at a sharp shadow edge to a cluster's other light
constexpr float kMinShare = 0.03f;      // of a cluster's light, below which the probes are enough

/// The sphere around some clusters of the same normal.
LightTree::Receiver receiver_of(const TileClusters& clusters, std::span<const std::uint32_t> some) {
  LightTree::Receiver receiver{Vec3d(0.0), 0.0, Vec3d(clusters[some[0]].normal)};
  for (const std::uint32_t s : some) receiver.center += clusters[s].center / double(some.size());
  for (const std::uint32_t s : some)
    receiver.radius = std::max(receiver.radius, (clusters[s].center - receiver.center).length() + clusters[s].radius);
  receiver.radius *= kMargin;
  return receiver;
}

}  // namespace

TileFurtherLight::TileFurtherLight(const FurtherLight& light, const TileClusters& clusters, const TileWindow& window,
                                   int samples)
    : light_(light),
      clusters_(clusters),
      window_(window),
      samples_(samples),
      block_(clusters.size(), 0),
      probes_(clusters.size()) {
  choose();
  for (std::size_t s = 0; s < clusters.size(); ++s)
    light_.sample(clusters[s], choices_[block_[s]], kProbes, hash64(~hash64(window_.pixel_id(clusters[s].pixel)) + s),
                  probes_[s]);
}

/// Chooses emitters for the flat clusters of one normal in each block of pixels.
void TileFurtherLight::choose() {
  choices_.emplace_back();  // for the other clusters
  std::map<std::pair<std::uint64_t, std::array<float, 3>>, std::vector<std::uint32_t>> blocks;
  for (std::uint32_t s = 0; s < clusters_.size(); ++s) {
    if (!clusters_[s].flat) continue;
    const std::uint64_t pixel = window_.pixel_id(clusters_[s].pixel);
    const Vec3f& normal = clusters_[s].normal;
    blocks[{(pixel >> 32) / kBlock << 32 | (pixel & 0xffffffffu) / kBlock, {normal.x, normal.y, normal.z}}].push_back(
        s);
  }
  for (const auto& [block, clusters] : blocks) {
    if (clusters.size() < kMinShared) continue;
    for (const std::uint32_t s : clusters) block_[s] = std::uint32_t(choices_.size());
    choices_.push_back(
        light_.choose(receiver_of(clusters_, clusters), kSharedChoices, hash64(hash64(block.first) + clusters[0])));
  }
}

/// What the probes around a cluster found without its own.
TileFurtherLight::Around TileFurtherLight::around(std::uint32_t pixel, std::int32_t cluster) const {
  Around result;
  int count = 0;
  float square = 0;
  const auto add = [&](std::int32_t s) {
    if (s < 0 || s == cluster) return;
    const float brightness = probes_[s].brightness();
    result.visibility.add(probes_[s].visibility);
    result.brightness += brightness;
    square += brightness * brightness;
    ++count;
  };
  if (cluster >= 0) std::ranges::for_each(clusters_.neighbours()[cluster], add);
  if (count == 0) clusters_.for_each_around(pixel, add);
  if (count > 0) result.brightness /= float(count);
  if (count > 1 && result.brightness > 0)
    result.variance = std::max(0.0f, square / (result.brightness * result.brightness * float(count)) - 1) *
                      float(count) / float(count - 1);
  return result;
}

bool TileFurtherLight::sharp(std::size_t s, float brightness) const {
  float lit = 0;
  bool dark = false;
  for (const std::int32_t t : clusters_.neighbours()[s]) {
    if (t < 0) continue;
    const Visibility& visibility = probes_[t].visibility;
    if (visibility.hidden == 0) lit = std::max(lit, probes_[t].brightness());
    dark = dark || (visibility.visible == 0 && visibility.hidden > 0);
  }
  return dark && lit > kMinSharpRatio * brightness;
}

/// Number of further choices at a cluster with a `part` of its pixel's points, a power of two; 0: its probes are
/// enough.
int TileFurtherLight::count(const Around& around, float brightness, float part) const {
  const float share = around.brightness / std::max(around.brightness + brightness, 1e-30f);
  if (share < kMinShare) return 0;
  const float wanted = kProbes * around.variance / (kNoise * kNoise);
  const int open = int(part * share * std::min(wanted, float(kMaxOpenChoices)));
  const int all =
      around.visibility.partial() ? std::max(open, ray_count(part * share, samples_, around.visibility)) : open;
  return std::max(kProbes, int(std::bit_ceil(unsigned(all))));
}

std::vector<Color> TileFurtherLight::result(const FurtherLight::Samples& samples, const Around& around) const {
  std::vector<Color> light;
  for (std::size_t g = 0; g < light_.groups(); ++g)
    light.push_back(samples.light(g, around.visibility.mostly_visible()));
  return light;
}

std::vector<Color> TileFurtherLight::at(std::size_t s, float brightness) const {
  const ShadingCluster& cluster = clusters_[s];
  const Around near = around(cluster.pixel, std::int32_t(s));
  FurtherLight::Samples samples = probes_[s];
  if (const int more = count(near, brightness); more > 0)
    light_.sample(cluster, choices_[block_[s]], more, hash64(hash64(window_.pixel_id(cluster.pixel)) + s), samples);
  return result(samples, near);
}

std::vector<Color> TileFurtherLight::at(const ShadingCluster& cluster, float part, std::uint64_t seed) const {
  const std::int32_t s = clusters_.at(cluster.pixel, cluster.surface, cluster.normal);
  const Around near = around(cluster.pixel, s);
  FurtherLight::Samples samples;
  light_.sample(cluster, s >= 0 ? choices_[block_[s]] : FurtherLight::Choices{},
                std::max(kProbes, count(near, 0.0f, part)), seed, samples);
  return result(samples, near);
}

}  // namespace patchlight

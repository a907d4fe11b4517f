#include "tracer/light/tile_light.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/random.h"

namespace patchlight {

namespace {

// A lamp's share is its part of a cluster's unoccluded light.
constexpr float kRaysPerSample = 8;          // for a single lamp that is half hidden
constexpr int kMinRays = 4;                  // to a lamp that is partly hidden
constexpr float kMinShare = 0.03f;           // below it a lamp takes no rays besides the probes
constexpr float kMinSharpShare = 0.3f;       // above it a lamp's sharp shadow edges take more points
constexpr float kMinSharpPointShare = 0.1f;  // the same for a light without extent, whose shadows are all sharp
constexpr double kFar = 2.0;                 // distance in radii of a lamp from which it is sampled by area
constexpr float kMinCosine = 0.95f;          // between the normals of a cluster and of a point that shares its light
constexpr int kMinProbes = 9;                // of one surface, below which those of other surfaces count too

/// Probes to a lamp of this share.
int probe_count(float share) {
  return share < 0.1f ? 1 : share < 0.4f ? 2 : 4;
}

/// Rays to a partly hidden lamp of this share, in proportion to the standard deviation of its visibility.
int ray_count(float share, int samples, const Visibility& visibility) {
  const float visible = visibility.visible_fraction();
  return std::max(kMinRays, int(kRaysPerSample * float(samples) * share * 2 * std::sqrt(visible * (1 - visible))));
}

/// Casts samples `first` to `first + count - 1` of a lamp, distributed over the points of a cluster.
void sample(const ExplicitLights::Lamp& lamp, const ShadingCluster& cluster, int count, std::uint64_t first,
            std::uint64_t shift, ShadowRays& rays, LightSamples& sums) {
  const int points = std::min(int(cluster.points.size()), count);
  for (int k = 0; k < points; ++k) {
    const ShadingPoint& point = cluster.points[std::size_t(k) * cluster.points.size() / std::size_t(points)];
    const DirectLight::View view = lamp.light.view(point.position, point.normal, kFar);
    for (int i = k; i < count; i += points) {
      const Vec2f to = kronecker2(first + std::uint64_t(i), shift);
      const DirectLight::Sample light = view.sample(to.x, to.y);
      ++sums.count;
      if (light.weight > 0) rays.add(point.position, light, sums);
    }
  }
}

/// Form factor to the visible part of a lamp, by samples or else by the local visibility. `unoccluded`: to all
/// of it.
float visible_factor(float unoccluded, const LightSamples& samples, const Visibility& visibility) {
  double factor = unoccluded * visibility.visible_fraction();
  if (samples.count > 0)
    factor = visibility.mostly_visible() ? samples.estimate_from_hidden(unoccluded) : samples.estimate_from_visible();
  return float(std::max(factor, 0.0));
}

}  // namespace

TileLight::Factors::Factors(const std::vector<Lamp>& lamps, const std::vector<ShadingCluster>& all)
    : unoccluded(lamps.size() * all.size()), total(all.size(), 0.0f), clusters(all.size()) {
  for (std::size_t l = 0; l < lamps.size(); ++l)
    for (std::size_t s = 0; s < clusters; ++s) {
      float& factor = unoccluded[l * clusters + s];
      factor = float(all[s].form_factor(lamps[l]));
      total[s] += factor * lamps[l].brightness();
    }
}

TileLight::TileLight(const ExplicitLights& lights, const Window& window, int samples, LayerSums* layers)
    : lights_(lights),
      window_(window),
      samples_(samples),
      layers_(layers),
      first_cluster_(std::size_t(window.pixels()) + 1, 0),
      sharp_(std::size_t(window.pixels()), 0) {}

void TileLight::probe(std::vector<ShadingPoint> points, std::span<const std::uint8_t> requested) {
  points_ = std::move(points);
  clusters_ = shading_clusters(points_);
  for (const ShadingCluster& cluster : clusters_) ++first_cluster_[cluster.pixel + 1];
  for (std::size_t k = 1; k < first_cluster_.size(); ++k) first_cluster_[k] += first_cluster_[k - 1];
  find_neighbours();
  const std::vector<Lamp>& lamps = lights_.lamps();
  const Factors factors(lamps, clusters_);
  counts_.assign(lamps.size() * clusters_.size(), {});
  irradiance_.assign(clusters_.size(), Color(0.0f));
  if (by_group()) irradiance_by_group_.assign(layers_->group_count(), irradiance_);
  ShadowRays rays(lights_.ray_scene());
  std::vector<LightSamples> sums(clusters_.size());
  for (std::size_t l = 0; l < lamps.size(); ++l) {
    std::fill(sums.begin(), sums.end(), LightSamples{});
    for (std::size_t s = 0; s < clusters_.size(); ++s) {
      if (factors.of(l, s) <= 0) continue;
      // The pixels of a 3 x 3 block take consecutive samples, which together cover the whole lamp.
      const std::uint64_t pixel_id = window_.pixel_id(clusters_[s].pixel);
      const std::uint64_t phase = (pixel_id >> 32) % 3 * 3 + (pixel_id & 0xffffffffu) % 3;
      const int count = probe_count(factors.share(lamps[l], l, s));
      sample(lamps[l], clusters_[s], count, phase * std::uint64_t(count), hash64(l), rays, sums[s]);
    }
    rays.cast();
    for (std::size_t s = 0; s < clusters_.size(); ++s)
      counts_[l * clusters_.size() + s] = {std::uint8_t(sums[s].visible), std::uint8_t(sums[s].hidden)};
    add_lamp(l, factors, requested);
  }
}

void TileLight::find_neighbours() {
  neighbours_.resize(clusters_.size());
  for (std::size_t s = 0; s < clusters_.size(); ++s) {
    const int x = int(clusters_[s].pixel) % window_.width, y = int(clusters_[s].pixel) / window_.width;
    for (int k = 0; k < 9; ++k) {
      const int u = x + k % 3 - 1, v = y + k / 3 - 1;
      const bool inside = u >= 0 && v >= 0 && u < window_.width && v < window_.height;
      neighbours_[s][k] =
          inside ? cluster_at(std::uint32_t(v * window_.width + u), clusters_[s].surface, clusters_[s].normal) : -1;
    }
  }
}

/// The probed cluster of a surface at a pixel with a similar normal; -1: none.
std::int32_t TileLight::cluster_at(std::uint32_t pixel, std::int32_t surface, const Vec3f& normal) const {
  for (std::uint32_t s = first_cluster_[pixel]; s < first_cluster_[pixel + 1]; ++s)
    if (clusters_[s].surface == surface && (clusters_[s].normal ^ normal) > kMinCosine) return std::int32_t(s);
  return -1;
}

void TileLight::add_lamp(std::size_t l, const Factors& factors, std::span<const std::uint8_t> requested) {
  const Lamp& lamp = lights_.lamps()[l];
  ShadowRays rays(lights_.ray_scene());
  std::vector<LightSamples> sums(clusters_.size());
  std::vector<LocalVisibility> visibility(clusters_.size());
  const auto takes_part = [&](std::size_t s) {
    return factors.of(l, s) > 0 && requested[clusters_[s].pixel] != 0 && sharp_[clusters_[s].pixel] == 0;
  };
  for (std::size_t s = 0; s < clusters_.size(); ++s) {
    if (!takes_part(s)) continue;
    visibility[s] = local_visibility(l, s);
    const float share = factors.share(lamp, l, s);
    if (visibility[s].sharp && share > (lamp.light.is_point() ? kMinSharpPointShare : kMinSharpShare))
      sharp_[clusters_[s].pixel] = 1;
    else if (visibility[s].samples.partial() && share >= kMinShare && is_needed(lamp))
      sample(lamp, clusters_[s], ray_count(share, samples_, visibility[s].samples), 0,
             hash64(hash64(window_.pixel_id(clusters_[s].pixel)) + l), rays, sums[s]);
  }
  rays.cast();
  for (std::size_t s = 0; s < clusters_.size(); ++s) {
    if (!takes_part(s)) continue;
    const float factor = visible_factor(factors.of(l, s), sums[s], visibility[s].samples);
    irradiance_[s] += lamp.exitance * factor;
    if (by_group()) irradiance_by_group_[lamp.group][s] += lamp.unscaled * factor;
  }
}

bool TileLight::add_probed(const ShadingPoint& point, std::span<Color> pixels) const {
  const std::int32_t s = cluster_at(point.pixel, point.surface, point.normal);
  if (s < 0) return false;
  pixels[point.pixel] += irradiance_[s] * point.weight;
  if (layers_ && layers_->has_light())
    layers_->add_direct(point.pixel, point.path_kind != ShadingPoint::PathKind::direct, irradiance_[s] * point.weight);
  for (std::size_t g = 0; g < irradiance_by_group_.size(); ++g)
    layers_->add_to_group(g, point.pixel, irradiance_by_group_[g][s] * point.weight);
  return true;
}

std::span<const ShadingPoint> TileLight::points(std::uint32_t pixel) const {
  const std::uint32_t first = first_cluster_[pixel], end = first_cluster_[pixel + 1];
  if (first == end) return {};
  return {clusters_[first].points.data(), clusters_[end - 1].points.data() + clusters_[end - 1].points.size()};
}

/// By the probes of a cluster and its neighbours.
TileLight::LocalVisibility TileLight::local_visibility(std::size_t lamp, std::size_t cluster) const {
  const Counts* counts = counts_.data() + lamp * clusters_.size();
  Visibility same;
  bool lit = false, dark = false;
  for (const std::int32_t s : neighbours_[cluster]) {
    if (s < 0) continue;
    same.visible += counts[s].visible;
    same.hidden += counts[s].hidden;
    lit = lit || (counts[s].hidden == 0 && counts[s].visible > 0);
    dark = dark || (counts[s].visible == 0 && counts[s].hidden > 0);
  }
  const bool enough = same.visible + same.hidden >= kMinProbes;
  return {enough ? same : pixel_visibility(lamp, clusters_[cluster].pixel), lit && dark};
}

/// By all probes from a pixel and its neighbours.
Visibility TileLight::pixel_visibility(std::size_t lamp, std::uint32_t pixel) const {
  const Counts* counts = counts_.data() + lamp * clusters_.size();
  const int x = int(pixel) % window_.width, y = int(pixel) / window_.width;
  const int left = std::max(0, x - 1), right = std::min(window_.width - 1, x + 1);
  Visibility all;
  for (int v = std::max(0, y - 1); v <= std::min(window_.height - 1, y + 1); ++v)
    for (std::uint32_t s = first_cluster_[v * window_.width + left]; s < first_cluster_[v * window_.width + right + 1];
         ++s) {
      all.visible += counts[s].visible;
      all.hidden += counts[s].hidden;
    }
  return all;
}

void TileLight::add(std::vector<ShadingPoint>& points, std::span<Color> pixels) const {
  const std::vector<Lamp>& lamps = lights_.lamps();
  if (lamps.empty() || points.empty()) return;
  const std::vector<ShadingCluster> clusters = shading_clusters(points);
  const Factors factors(lamps, clusters);
  std::vector<std::uint32_t> points_of_pixel(pixels.size(), 0);
  std::vector<std::uint64_t> seeds(clusters.size());
  std::vector<std::int32_t> probed(clusters.size());  // indices of the clusters that were probed; -1: none
  for (std::size_t s = 0; s < clusters.size(); ++s) {
    seeds[s] = hash64(hash64(window_.pixel_id(clusters[s].pixel)) + points_of_pixel[clusters[s].pixel]);
    probed[s] = cluster_at(clusters[s].pixel, clusters[s].surface, clusters[s].normal);
    points_of_pixel[clusters[s].pixel] += std::uint32_t(clusters[s].points.size());
  }
  ShadowRays rays(lights_.ray_scene());
  std::vector<LightSamples> probes(clusters.size()), samples(clusters.size());
  std::vector<Visibility> visibility(clusters.size());
  for (std::size_t l = 0; l < lamps.size(); ++l) {
    if (!is_needed(lamps[l])) continue;
    std::fill(probes.begin(), probes.end(), LightSamples{});
    std::fill(samples.begin(), samples.end(), LightSamples{});
    for (std::size_t s = 0; s < clusters.size(); ++s) {
      if (factors.of(l, s) <= 0) continue;
      visibility[s] =
          probed[s] >= 0 ? local_visibility(l, std::size_t(probed[s])).samples : pixel_visibility(l, clusters[s].pixel);
      if (clusters[s].points.size() < points_of_pixel[clusters[s].pixel])
        sample(lamps[l], clusters[s], probe_count(factors.share(lamps[l], l, s)), 0, hash64(seeds[s] + 2 * l), rays,
               probes[s]);
    }
    rays.cast();
    for (std::size_t s = 0; s < clusters.size(); ++s) {
      if (factors.of(l, s) <= 0) continue;
      visibility[s].add(probes[s]);
      const float share = factors.share(lamps[l], l, s);
      const bool scattered = clusters[s].scattered;  // then visibility from other points tells nothing
      if ((!visibility[s].partial() && !scattered) || share < kMinShare) continue;
      const float part = float(clusters[s].points.size()) / float(points_of_pixel[clusters[s].pixel]);
      const int count = scattered ? std::max(kMinRays, int(share * float(clusters[s].points.size())))
                                  : ray_count(part * share, samples_, visibility[s]);
      sample(lamps[l], clusters[s], count, 0, hash64(seeds[s] + 2 * l + 1), rays, samples[s]);
    }
    rays.cast();
    for (std::size_t s = 0; s < clusters.size(); ++s) {
      if (factors.of(l, s) <= 0) continue;
      const ShadingCluster& cluster = clusters[s];
      const float factor = visible_factor(factors.of(l, s), samples[s], visibility[s]);
      const Color light = lamps[l].exitance * factor;
      pixels[cluster.pixel] += cluster.weight * light;
      if (layers_ && layers_->has_light()) {
        layers_->add_direct(cluster.pixel, false, (cluster.weight - cluster.mirrored) * light);
        layers_->add_direct(cluster.pixel, true, cluster.mirrored * light);
      }
      if (by_group())
        layers_->add_to_group(std::size_t(lamps[l].group), cluster.pixel, cluster.weight * lamps[l].unscaled * factor);
    }
  }
}

}  // namespace patchlight

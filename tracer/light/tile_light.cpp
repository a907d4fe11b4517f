#include "tracer/light/tile_light.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/random.h"

namespace patchlight {

namespace {

constexpr float kPartial = 8;          // rays for each of a pixel's samples where the one lamp is half hidden
constexpr int kLeast = 4;              // rays where a lamp is partly hidden
constexpr float kLittle = 0.03f;       // part of a spot's light below which a lamp takes no more than a look
constexpr float kSharp = 0.3f;         // part of a spot's light above which a lamp's sharp shadows take more points
constexpr float kSharpOfPoint = 0.1f;  // the same of a light without extent, whose shadows all are
constexpr double kFar = 2.0;           // radii of a lamp from where its area is as good as its solid angle
constexpr float kAlike = 0.95f;        // cosine between the normals of a spot and of a point that gets as much light
constexpr int kEnough = 9;             // looks from one surface that need no others

/// Rays of a look at a lamp that brings this part of a spot's light.
int probe_count(float share) {
  return share < 0.1f ? 1 : share < 0.4f ? 2 : 4;
}

/// Rays at a spot where a lamp is partly hidden that brings this part of its light: as many as the seen part of it can
/// vary.
int rays_for(float share, int samples, const Visibility& around) {
  const float seen = around.part_seen();
  return std::max(kLeast, int(kPartial * float(samples) * share * 2 * std::sqrt(seen * (1 - seen))));
}

/// Samples `first` to `first + count` of a lamp, shared out among some points of a spot.
void sample(const PixelLight::Lamp& lamp, const ShadingCluster& cluster, int count, std::uint64_t first,
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

/// Form factor to what is seen of a lamp: from samples, or from what is seen of it about there. `whole`: to all of it.
float seen_factor(float whole, const LightSamples& samples, const Visibility& around) {
  double factor = whole * around.part_seen();
  if (samples.count > 0) factor = around.mostly_seen() ? samples.from_hidden(whole) : samples.from_seen();
  return float(std::max(factor, 0.0));
}

}  // namespace

TileLight::Factors::Factors(const std::vector<Lamp>& lamps, const std::vector<ShadingCluster>& all)
    : whole(lamps.size() * all.size()), total(all.size(), 0.0f), clusters(all.size()) {
  for (std::size_t l = 0; l < lamps.size(); ++l)
    for (std::size_t s = 0; s < clusters; ++s) {
      float& factor = whole[l * clusters + s];
      factor = float(all[s].form_factor(lamps[l]));
      total[s] += factor * lamps[l].brightness();
    }
}

TileLight::TileLight(const PixelLight& lights, const Window& window, int samples, LayerSums* layers)
    : lights_(lights),
      window_(window),
      samples_(samples),
      layers_(layers),
      first_cluster_(std::size_t(window.pixels()) + 1, 0),
      sharp_(std::size_t(window.pixels()), 0) {}

void TileLight::look(std::vector<ShadingPoint> points, std::span<const std::uint8_t> wanted) {
  points_ = std::move(points);
  clusters_ = shading_clusters(points_);
  for (const ShadingCluster& cluster : clusters_) ++first_cluster_[cluster.pixel + 1];
  for (std::size_t k = 1; k < first_cluster_.size(); ++k) first_cluster_[k] += first_cluster_[k - 1];
  find_neighbours();
  const std::vector<Lamp>& lamps = lights_.lamps();
  const Factors factors(lamps, clusters_);
  counts_.assign(lamps.size() * clusters_.size(), {});
  seen_.assign(clusters_.size(), Color(0.0f));
  if (by_group()) seen_of_group_.assign(layers_->group_count(), seen_);
  ShadowRays rays(lights_.ray_scene());
  std::vector<LightSamples> sums(clusters_.size());
  for (std::size_t l = 0; l < lamps.size(); ++l) {
    std::fill(sums.begin(), sums.end(), LightSamples{});
    for (std::size_t s = 0; s < clusters_.size(); ++s) {
      if (factors.of(l, s) <= 0) continue;
      // Pixels of a square of three take samples that follow each other, so that together they look at all of the lamp.
      const std::uint64_t place = window_.place(clusters_[s].pixel);
      const std::uint64_t turn = (place >> 32) % 3 * 3 + (place & 0xffffffffu) % 3;
      const int count = probe_count(factors.share(lamps[l], l, s));
      sample(lamps[l], clusters_[s], count, turn * std::uint64_t(count), hash64(l), rays, sums[s]);
    }
    rays.cast();
    for (std::size_t s = 0; s < clusters_.size(); ++s)
      counts_[l * clusters_.size() + s] = {std::uint8_t(sums[s].visible), std::uint8_t(sums[s].hidden)};
    add_to_seen(l, factors, wanted);
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

/// The first look's spot at a pixel that is of a surface and faces about alike; -1: none.
std::int32_t TileLight::cluster_at(std::uint32_t pixel, std::int32_t surface, const Vec3f& normal) const {
  for (std::uint32_t s = first_cluster_[pixel]; s < first_cluster_[pixel + 1]; ++s)
    if (clusters_[s].surface == surface && (clusters_[s].normal ^ normal) > kAlike) return std::int32_t(s);
  return -1;
}

void TileLight::add_to_seen(std::size_t l, const Factors& factors, std::span<const std::uint8_t> wanted) {
  const Lamp& lamp = lights_.lamps()[l];
  ShadowRays rays(lights_.ray_scene());
  std::vector<LightSamples> sums(clusters_.size());
  std::vector<About> around(clusters_.size());
  const auto takes_part = [&](std::size_t s) {
    return factors.of(l, s) > 0 && wanted[clusters_[s].pixel] != 0 && sharp_[clusters_[s].pixel] == 0;
  };
  for (std::size_t s = 0; s < clusters_.size(); ++s) {
    if (!takes_part(s)) continue;
    around[s] = about(l, s);
    const float share = factors.share(lamp, l, s);
    if (around[s].sharp && share > (lamp.light.is_point() ? kSharpOfPoint : kSharp))
      sharp_[clusters_[s].pixel] = 1;
    else if (around[s].samples.partial() && share >= kLittle && is_needed(lamp))
      sample(lamp, clusters_[s], rays_for(share, samples_, around[s].samples), 0,
             hash64(hash64(window_.place(clusters_[s].pixel)) + l), rays, sums[s]);
  }
  rays.cast();
  for (std::size_t s = 0; s < clusters_.size(); ++s) {
    if (!takes_part(s)) continue;
    const float factor = seen_factor(factors.of(l, s), sums[s], around[s].samples);
    seen_[s] += lamp.exitance * factor;
    if (by_group()) seen_of_group_[lamp.group][s] += lamp.own * factor;
  }
}

bool TileLight::add_seen(const ShadingPoint& point, std::span<Color> pixels) const {
  const std::int32_t s = cluster_at(point.pixel, point.surface, point.normal);
  if (s < 0) return false;
  pixels[point.pixel] += seen_[s] * point.weight;
  if (layers_ && layers_->light())
    layers_->add_direct(point.pixel, point.way != ShadingPoint::Way::straight, seen_[s] * point.weight);
  for (std::size_t g = 0; g < seen_of_group_.size(); ++g)
    layers_->add_of_group(g, point.pixel, seen_of_group_[g][s] * point.weight);
  return true;
}

std::span<const ShadingPoint> TileLight::points(std::uint32_t pixel) const {
  const std::uint32_t first = first_cluster_[pixel], end = first_cluster_[pixel + 1];
  if (first == end) return {};
  return {clusters_[first].points.data(), clusters_[end - 1].points.data() + clusters_[end - 1].points.size()};
}

/// As the first look saw it from a spot and its neighbours.
TileLight::About TileLight::about(std::size_t lamp, std::size_t cluster) const {
  const Counts* counts = counts_.data() + lamp * clusters_.size();
  Visibility same;
  bool bright = false, dark = false;
  for (const std::int32_t s : neighbours_[cluster]) {
    if (s < 0) continue;
    same.visible += counts[s].visible;
    same.hidden += counts[s].hidden;
    bright = bright || (counts[s].hidden == 0 && counts[s].visible > 0);
    dark = dark || (counts[s].visible == 0 && counts[s].hidden > 0);
  }
  const bool enough = same.visible + same.hidden >= kEnough;
  return {enough ? same : about_pixel(lamp, clusters_[cluster].pixel), bright && dark};
}

/// As it saw it from all that is at a pixel and its neighbours.
Visibility TileLight::about_pixel(std::size_t lamp, std::uint32_t pixel) const {
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
  std::vector<std::uint32_t> of_pixel(pixels.size(), 0);  // points
  std::vector<std::uint64_t> seeds(clusters.size());
  std::vector<std::int32_t> firsts(clusters.size());  // spots of the first look
  for (std::size_t s = 0; s < clusters.size(); ++s) {
    seeds[s] = hash64(hash64(window_.place(clusters[s].pixel)) + of_pixel[clusters[s].pixel]);
    firsts[s] = cluster_at(clusters[s].pixel, clusters[s].surface, clusters[s].normal);
    of_pixel[clusters[s].pixel] += std::uint32_t(clusters[s].points.size());
  }
  ShadowRays rays(lights_.ray_scene());
  std::vector<LightSamples> own(clusters.size()), more(clusters.size());
  std::vector<Visibility> around(clusters.size());
  for (std::size_t l = 0; l < lamps.size(); ++l) {
    if (!is_needed(lamps[l])) continue;
    std::fill(own.begin(), own.end(), LightSamples{});
    std::fill(more.begin(), more.end(), LightSamples{});
    for (std::size_t s = 0; s < clusters.size(); ++s) {
      if (factors.of(l, s) <= 0) continue;
      around[s] = firsts[s] >= 0 ? about(l, std::size_t(firsts[s])).samples : about_pixel(l, clusters[s].pixel);
      if (clusters[s].points.size() < of_pixel[clusters[s].pixel])
        sample(lamps[l], clusters[s], probe_count(factors.share(lamps[l], l, s)), 0, hash64(seeds[s] + 2 * l), rays,
               own[s]);
    }
    rays.cast();
    for (std::size_t s = 0; s < clusters.size(); ++s) {
      if (factors.of(l, s) <= 0) continue;
      around[s].add(own[s]);
      const float share = factors.share(lamps[l], l, s);
      const bool scattered = clusters[s].scattered;  // then what is seen from elsewhere says nothing
      if ((!around[s].partial() && !scattered) || share < kLittle) continue;
      const float part = float(clusters[s].points.size()) / float(of_pixel[clusters[s].pixel]);
      const int count = scattered ? std::max(kLeast, int(share * float(clusters[s].points.size())))
                                  : rays_for(part * share, samples_, around[s]);
      sample(lamps[l], clusters[s], count, 0, hash64(seeds[s] + 2 * l + 1), rays, more[s]);
    }
    rays.cast();
    for (std::size_t s = 0; s < clusters.size(); ++s) {
      if (factors.of(l, s) <= 0) continue;
      const ShadingCluster& cluster = clusters[s];
      const float factor = seen_factor(factors.of(l, s), more[s], around[s]);
      const Color light = lamps[l].exitance * factor;
      pixels[cluster.pixel] += cluster.weight * light;
      if (layers_ && layers_->light()) {
        layers_->add_direct(cluster.pixel, false, (cluster.weight - cluster.mirrored) * light);
        layers_->add_direct(cluster.pixel, true, cluster.mirrored * light);
      }
      if (by_group())
        layers_->add_of_group(std::size_t(lamps[l].group), cluster.pixel, cluster.weight * lamps[l].own * factor);
    }
  }
}

}  // namespace patchlight

#include "tracer/light/lamps/tile_light.h"

#include <algorithm>
#include <cmath>

#include "tracer/light/lamps/lamp_samples.h"

namespace patchlight {

namespace {

constexpr float kMinShare = 0.03f;           // below it a lamp takes no rays besides the probes
constexpr float kMinSharpShare = 0.3f;       // above it a lamp's sharp shadow edges take more points
constexpr float kMinSharpPointShare = 0.1f;  // the same for a light without extent, whose shadows are all sharp
constexpr float kDim = 0.1f;                 // visible fraction below which a lamp's rays may be guided
constexpr int kMinScatteredRays = 4;         // of a cluster that a rough metal sees
constexpr int kMinGuidedRays = 64;           // of a cluster

auto kronecker_places(std::uint64_t shift) {
  return [=](int k) { return kronecker2(std::uint64_t(k), shift); };
}

}  // namespace

TileLight::Factors::Factors(const std::vector<Lamp>& lamps, const std::vector<ShadingCluster>& all)
    : unoccluded(lamps.size() * all.size()), total(all.size(), 0.0f), clusters(all.size()) {
  for (std::size_t l = 0; l < lamps.size(); ++l)
    for (std::size_t s = 0; s < clusters; ++s) {
      float& factor = unoccluded[l * clusters + s];
      factor = float(all[s].form_factor(lamps[l].light, lamps[l].emitter));
      total[s] += factor * lamps[l].brightness();
    }
}

TileLight::TileLight(const ExplicitLights& lights, const FurtherLight& further, const TileWindow& window, int samples,
                     LayerSums* layers)
    : lights_(lights),
      further_(further),
      window_(window),
      samples_(samples),
      layers_(layers),
      clusters_(window),
      probes_(clusters_),
      sharp_(std::size_t(window.pixels()), 0) {}

void TileLight::probe(std::vector<ShadingPoint> points, std::span<const std::uint8_t> requested) {
  clusters_ = TileClusters(window_, std::move(points));
  const std::vector<Lamp>& lamps = lights_.lamps();
  const Factors factors(lamps, clusters_.all());
  irradiance_.assign(clusters_.size(), Color(0.0f));
  if (by_group()) irradiance_by_group_.assign(layers_->group_count(), irradiance_);
  std::vector<float> visible_light(clusters_.size(), 0.0f);
  std::vector<std::vector<LightSamples>> probes(lamps.size());
  for (std::size_t l = 0; l < lamps.size(); ++l) {
    probes[l] = probe_lamp(l, factors);
    for (std::size_t s = 0; s < clusters_.size(); ++s) {
      visible_light[s] += float(probes[l][s].seen) * lamps[l].brightness() / float(std::max(1, probes[l][s].count));
    }
    probes_.add(probes[l], lights_.ray_scene().has_passable());
  }
  for (std::size_t l = 0; l < lamps.size(); ++l) add_lamp(l, factors, probes[l], visible_light, requested);
  if (further_.empty() || (further_.is_off() && !by_group())) return;
  tile_further_.emplace(further_, clusters_, window_, samples_);
  for (std::size_t s = 0; s < clusters_.size(); ++s) {
    std::uint8_t& sharp = sharp_[clusters_[s].pixel];
    if (requested[clusters_[s].pixel] == 0 || sharp != 0) continue;
    sharp = tile_further_->sharp(s, visible_light[s]);
    if (sharp != 0) continue;
    const std::vector<Color> light = tile_further_->at(s, visible_light[s]);
    for (std::size_t g = 0; g < light.size(); ++g) add_light(s, g, light[g], light[g] * further_.setting(g));
  }
}

void TileLight::add_light(std::size_t s, std::size_t group, const Color& unscaled, const Color& scaled) {
  irradiance_[s] += scaled;
  if (by_group()) irradiance_by_group_[group][s] += unscaled;
}

std::vector<LightSamples> TileLight::probe_lamp(std::size_t l, const Factors& factors) const {
  ShadowRays rays(lights_.ray_scene());
  std::vector<LightSamples> sums(clusters_.size());
  for (std::size_t s = 0; s < clusters_.size(); ++s) {
    if (factors.of(l, s) <= 0) continue;
    const int x = window_.x0 + int(clusters_[s].pixel) % window_.width;
    const int y = window_.y0 + int(clusters_[s].pixel) / window_.width;
    const auto place = [&](int k) { return probe_place(x, y, k, hash64(l)); };
    const Lamp& lamp = lights_.lamps()[l];
    sample_lamp(lamp, clusters_[s], probe_count(factors.share(lamp, l, s)), place, rays, sums[s]);
  }
  rays.cast();
  return sums;
}

void TileLight::add_lamp(std::size_t l, const Factors& factors, const std::vector<LightSamples>& probes,
                         const std::vector<float>& visible_light, std::span<const std::uint8_t> requested) {
  const Lamp& lamp = lights_.lamps()[l];
  ShadowRays rays(lights_.ray_scene());
  std::vector<LightSamples> sums(clusters_.size());
  std::vector<LampProbes::Local> visibility(clusters_.size());
  std::vector<std::uint32_t> dim;
  const auto takes_part = [&](std::size_t s) {
    return factors.of(l, s) > 0 && requested[clusters_[s].pixel] != 0 && sharp_[clusters_[s].pixel] == 0;
  };
  for (std::size_t s = 0; s < clusters_.size(); ++s) {
    if (!takes_part(s)) continue;
    visibility[s] = probes_.around(l, s);
    const float share = factors.share(lamp, l, s);
    if (visibility[s].sharp && share > (lamp.light.is_point() ? kMinSharpPointShare : kMinSharpShare)) {
      sharp_[clusters_[s].pixel] = 1;
    } else if (share >= kMinShare && is_needed(lamp)) {
      const bool may_dominate = factors.of(l, s) * lamp.brightness() > visible_light[s];
      const bool seen_by_others = probes_.reaching(l) > (probes[s].visible > 0);
      if (may_dominate && seen_by_others && !lamp.light.is_point() && visibility[s].samples.visible_fraction() < kDim)
        dim.push_back(std::uint32_t(s));
      else if (visibility[s].samples.partial())
        sample_lamp(lamp, clusters_[s], ray_count(share, samples_, visibility[s].samples),
                    kronecker_places(hash64(hash64(window_.pixel_id(clusters_[s].pixel)) + l)), rays, sums[s]);
    }
  }
  rays.cast();
  std::vector<float> values(clusters_.size(), 0.0f), residuals(clusters_.size(), 0.0f);
  for (std::size_t s = 0; s < clusters_.size(); ++s) {
    if (!takes_part(s)) continue;
    const Visibility& around = visibility[s].samples;
    if (sums[s].count > 0) {
      values[s] = visible_factor(factors.of(l, s), sums[s], around);
    } else if (around.partial()) {  // a faint lamp
      Visibility all = around;
      all.add(probes[s]);
      values[s] = factors.of(l, s) * all.visible_fraction();
    } else {
      values[s] = around.mostly_visible() ? factors.of(l, s) : 0.0f;
      residuals[s] = visible_factor(factors.of(l, s), probes[s], around) - values[s];
    }
  }
  if (!dim.empty()) add_guided(l, probes, dim, values, residuals);
  spread(residuals, takes_part, values);
  for (std::size_t s = 0; s < clusters_.size(); ++s) {
    if (!takes_part(s) || values[s] == 0) continue;
    const Color tint = sums[s].seen > 0 ? sums[s].tint() : probes_.tint(l, s);
    const Color factor = tint * (values[s] * float(clusters_[s].terminator(lamp.light)));
    add_light(s, std::size_t(lamp.group), lamp.unscaled * factor, lamp.exitance * factor);
  }
}

/// Sets the form factors of clusters that see little of a lamp.
void TileLight::add_guided(std::size_t l, const std::vector<LightSamples>& probes, std::span<const std::uint32_t> dim,
                           std::vector<float>& values, std::vector<float>& residuals) const {
  const Lamp& lamp = lights_.lamps()[l];
  GuidedLight guided(lights_.ray_scene(), lamp.light, clusters_);
  for (std::size_t s = 0; s < clusters_.size(); ++s)
    if (probes[s].visible > 0) guided.add(s, probes[s].reached);
  const auto factors = guided.factors(dim, std::max(kMinGuidedRays, samples_), hash64(hash64(window_.pixel_id(0)) + l));
  for (std::size_t k = 0; k < dim.size(); ++k) {
    if (!factors[k].found) continue;
    values[dim[k]] = float(factors[k].guided);
    residuals[dim[k]] = float(factors[k].rest);
  }
}

/// Adds equal parts of each cluster's residual to itself and its neighbours, so that the sum stays.
template <class TakesPart>
void TileLight::spread(const std::vector<float>& residuals, TakesPart takes_part, std::vector<float>& values) const {
  for (std::size_t s = 0; s < residuals.size(); ++s) {
    if (residuals[s] == 0) continue;
    const auto inside = [&](std::int32_t t) { return t >= 0 && takes_part(std::size_t(t)); };
    const auto count = std::ranges::count_if(clusters_.neighbours()[s], inside);
    for (const std::int32_t t : clusters_.neighbours()[s])
      if (inside(t)) values[t] += residuals[s] / float(count);
  }
}

bool TileLight::add_probed(const ShadingPoint& point, std::span<Color> pixels) const {
  const std::int32_t s = clusters_.at(point.pixel, point.surface, point.normal);
  if (s < 0) return false;
  pixels[point.pixel] += irradiance_[s] * point.weight;
  if (layers_ && layers_->has_light()) layers_->add_direct(point.pixel, point.seen_by, irradiance_[s] * point.weight);
  for (std::size_t g = 0; g < irradiance_by_group_.size(); ++g)
    layers_->add_to_group(g, point.pixel, irradiance_by_group_[g][s] * point.weight);
  return true;
}

void TileLight::add(std::vector<ShadingPoint>& points, std::span<Color> pixels) const {
  const std::vector<Lamp>& lamps = lights_.lamps();
  if (points.empty()) return;
  const std::vector<ShadingCluster> clusters = shading_clusters(points);
  const Factors factors(lamps, clusters);
  std::vector<std::uint32_t> points_of_pixel(pixels.size(), 0);
  std::vector<std::uint64_t> seeds(clusters.size());
  std::vector<std::int32_t> probed(clusters.size());  // indices of the clusters that were probed; -1: none
  for (std::size_t s = 0; s < clusters.size(); ++s) {
    seeds[s] = hash64(hash64(window_.pixel_id(clusters[s].pixel)) + points_of_pixel[clusters[s].pixel]);
    probed[s] = clusters_.at(clusters[s].pixel, clusters[s].surface, clusters[s].normal);
    points_of_pixel[clusters[s].pixel] += std::uint32_t(clusters[s].points.size());
  }
  ShadowRays rays(lights_.ray_scene());
  std::vector<LightSamples> probes(clusters.size()), samples(clusters.size());
  std::vector<Visibility> visibility(clusters.size()), own(clusters.size());
  for (std::size_t l = 0; l < lamps.size(); ++l) {
    if (!is_needed(lamps[l])) continue;
    std::fill(probes.begin(), probes.end(), LightSamples{});
    std::fill(samples.begin(), samples.end(), LightSamples{});
    for (std::size_t s = 0; s < clusters.size(); ++s) {
      if (factors.of(l, s) <= 0) continue;
      visibility[s] = probed[s] >= 0 ? probes_.around(l, std::size_t(probed[s])).samples
                                     : probes_.around_pixel(l, clusters[s].pixel);
      own[s] = {};
      if (probed[s] >= 0) own[s] = probes_.of(l, std::size_t(probed[s]));
      if (clusters[s].points.size() < points_of_pixel[clusters[s].pixel])
        sample_lamp(lamps[l], clusters[s], probe_count(factors.share(lamps[l], l, s)),
                    kronecker_places(hash64(seeds[s] + 2 * l)), rays, probes[s]);
    }
    rays.cast();
    for (std::size_t s = 0; s < clusters.size(); ++s) {
      if (factors.of(l, s) <= 0) continue;
      own[s].add(probes[s]);
      const float share = factors.share(lamps[l], l, s);
      const bool scattered = clusters[s].scattered;  // then visibility from other points tells nothing
      const bool may_be_found = visibility[s].visible == 0 && probes_.reaching(l) != 0;
      const bool unknown = own[s].visible + own[s].hidden == 0;  // all probes went below the horizon
      const bool partial = visibility[s].partial() || scattered || may_be_found;
      if (!unknown && (!partial || share < kMinShare)) continue;
      const float part = float(clusters[s].points.size()) / float(points_of_pixel[clusters[s].pixel]);
      const int count = scattered ? std::max(kMinScatteredRays, int(share * float(clusters[s].points.size())))
                                  : ray_count(part * share, samples_, visibility[s]);
      sample_lamp(lamps[l], clusters[s], count, kronecker_places(hash64(seeds[s] + 2 * l + 1)), rays, samples[s]);
    }
    rays.cast();
    for (std::size_t s = 0; s < clusters.size(); ++s) {
      if (factors.of(l, s) <= 0) continue;
      const ShadingCluster& cluster = clusters[s];
      if (visibility[s].partial()) own[s].add(visibility[s]);
      const float visible = samples[s].count > 0 ? visible_factor(factors.of(l, s), samples[s], visibility[s])
                                                 : factors.of(l, s) * own[s].visible_fraction();
      probes[s].add_light(samples[s]);
      const bool is_known = probes[s].seen > 0 || probed[s] < 0;
      const Color tint = is_known ? probes[s].tint() : probes_.tint(l, std::size_t(probed[s]));
      const Color factor = tint * (visible * float(cluster.terminator(lamps[l].light)));
      add_light(cluster, std::size_t(lamps[l].group), lamps[l].unscaled * factor, lamps[l].exitance * factor, pixels);
    }
  }
  for (std::size_t s = 0; s < clusters.size() && tile_further_; ++s) {
    const float part = float(clusters[s].points.size()) / float(points_of_pixel[clusters[s].pixel]);
    const std::vector<Color> light = tile_further_->at(clusters[s], part, hash64(~seeds[s]));
    for (std::size_t g = 0; g < light.size(); ++g)
      add_light(clusters[s], g, light[g], light[g] * further_.setting(g), pixels);
  }
}

void TileLight::add_light(const ShadingCluster& cluster, std::size_t group, const Color& unscaled, const Color& scaled,
                          std::span<Color> pixels) const {
  pixels[cluster.pixel] += cluster.weight * scaled;
  if (layers_ && layers_->has_light())
    for (std::size_t by = 0; by < cluster.weights.size(); ++by)
      layers_->add_direct(cluster.pixel, SeenBy(by), cluster.weights[by] * scaled);
  if (by_group()) layers_->add_to_group(group, cluster.pixel, cluster.weight * unscaled);
}

}  // namespace patchlight

#include "tracer/pixel_light.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/random.h"

namespace patchlight {

namespace {

constexpr int kPilots = 4;     // samples of a spot to begin with, at most one for each of its points
constexpr float kPartial = 8;  // samples for each point where visibility is partial, of a lamp that brings half of all
constexpr float kLittle = 0.01f;  // part of a spot's light below which a lamp is sampled once
constexpr float kAlike = 0.98f;   // cosine between the normals of a spot
constexpr double kSmall = 0.05;  // radius of a spot over its distance from a lamp where its middle stands for all of it

float brightness(const Color& c) {
  return c.x + c.y + c.z;
}

}  // namespace

/// The points of a pixel on one primitive.
struct PixelLight::Spot {
  std::uint32_t pixel = 0;
  std::int32_t primitive = 0;
  std::span<const ShadingPoint> points;
  Vec3d middle{0.0};
  Vec3f normal{0.0f};
  double radius = 0.0;
  Color weight{0.0f};

  explicit Spot(std::span<const ShadingPoint> all) : pixel(all[0].pixel), primitive(all[0].primitive), points(all) {
    for (const ShadingPoint& p : points) {
      middle += p.position / double(points.size());
      normal += p.normal;
      weight += p.weight;
    }
    normal.normalize();
    for (const ShadingPoint& p : points) radius = std::max(radius, (p.position - middle).length());
    weight /= float(points.size());
  }

  double form_factor(const Lamp& lamp) const {
    if (lamp.primitive == primitive) return 0.0;
    if (radius < kSmall * lamp.light.distance(middle)) return lamp.light.form_factor(middle, normal);
    double sum = 0;
    for (const ShadingPoint& p : points) sum += lamp.light.form_factor(p.position, p.normal);
    return sum / double(points.size());
  }
};

/// One lamp after the other over all spots of a tile.
class PixelLight::Tile {
 public:
  Tile(const PixelLight& lights, const std::vector<Spot>& spots, int width, std::uint64_t seed, std::span<Color> pixels)
      : lights_(lights),
        spots_(spots),
        width_(width),
        height_(int(pixels.size()) / width),
        seed_(seed),
        pixels_(pixels),
        rays_(lights.ray_scene_) {}

  void add_lamps() {
    const std::size_t lamps = lights_.lamps_.size();
    std::vector<float> whole(lamps * spots_.size()), total(spots_.size(), 0.0f);
    for (std::size_t l = 0; l < lamps; ++l)
      for (std::size_t s = 0; s < spots_.size(); ++s) {
        float& factor = whole[l * spots_.size() + s];
        factor = float(spots_[s].form_factor(lights_.lamps_[l]));
        total[s] += factor * brightness(lights_.lamps_[l].exitance);
      }
    for (std::size_t l = 0; l < lamps; ++l)
      add_lamp(lights_.lamps_[l], scramble(seed_ + l), std::span(whole).subspan(l * spots_.size(), spots_.size()),
               total);
  }

 private:
  void add_lamp(const Lamp& lamp, std::uint64_t random, std::span<const float> whole, const std::vector<float>& total) {
    const auto share = [&](std::size_t s) { return whole[s] * brightness(lamp.exitance) / total[s]; };
    std::vector<LightSamples> pilots(spots_.size()), more(spots_.size());
    for (std::size_t s = 0; s < spots_.size(); ++s) {
      if (whole[s] <= 0) continue;
      const int most = share(s) < kLittle ? 1 : kPilots;
      sample(lamp, spots_[s], std::min(int(spots_[s].points.size()), most), random + 2 * s, pilots[s]);
    }
    rays_.cast();
    std::vector<Visibility> seen(pixels_.size());
    for (std::size_t s = 0; s < spots_.size(); ++s) seen[spots_[s].pixel].add(pilots[s]);
    std::vector<Visibility> around(spots_.size());
    for (std::size_t s = 0; s < spots_.size(); ++s) {
      if (whole[s] <= 0) continue;
      around[s] = about(spots_[s].pixel, seen);
      if (!around[s].partial() || share(s) < kLittle) continue;
      const float samples = kPartial * float(spots_[s].points.size()) * std::min(2 * share(s), 1.0f);
      sample(lamp, spots_[s], std::max(kPilots, int(samples)), random + 2 * s + 1, more[s]);
    }
    rays_.cast();
    for (std::size_t s = 0; s < spots_.size(); ++s) {
      if (whole[s] <= 0) continue;
      const LightSamples& best = more[s].count > 0 ? more[s] : pilots[s];
      const double factor = around[s].mostly_seen() ? best.from_hidden(whole[s]) : best.from_seen();
      const Color irradiance = lamp.exitance * float(std::max(factor, 0.0));
      pixels_[spots_[s].pixel] += spots_[s].weight * irradiance * float(spots_[s].points.size());
    }
  }

  /// What the pilots of a pixel and its neighbours saw.
  Visibility about(std::uint32_t pixel, const std::vector<Visibility>& seen) const {
    const int x = int(pixel) % width_, y = int(pixel) / width_;
    Visibility sum;
    for (int v = std::max(0, y - 1); v <= std::min(height_ - 1, y + 1); ++v)
      for (int u = std::max(0, x - 1); u <= std::min(width_ - 1, x + 1); ++u) {
        sum.visible += seen[v * width_ + u].visible;
        sum.hidden += seen[v * width_ + u].hidden;
      }
    return sum;
  }

  void sample(const Lamp& lamp, const Spot& spot, int count, std::uint64_t random, LightSamples& sums) {
    const std::uint64_t shift = scramble(random);
    const std::size_t points = spot.points.size();
    for (int k = 0; k < count; ++k) {
      const std::size_t at = std::size_t(count) < points ? k * points / std::size_t(count) : std::size_t(k) % points;
      const ShadingPoint& point = spot.points[at];
      const Vec2f to = kronecker2(std::uint64_t(k), shift);
      const DirectLight::Sample light = lamp.light.sample(point.position, point.normal, to.x, to.y);
      ++sums.count;
      if (light.weight > 0) rays_.add(point.position, light, sums);
    }
  }

  const PixelLight& lights_;
  const std::vector<Spot>& spots_;
  const int width_, height_;
  const std::uint64_t seed_;
  const std::span<Color> pixels_;
  ShadowRays rays_;
};

PixelLight::PixelLight(const PatchSet& scene, const RayScene& ray_scene, const std::vector<Color>& emission)
    : ray_scene_(ray_scene) {
  for (const Emitter& emitter : emitters_apart(scene)) {
    const Color exitance = emission[emitter.first_patch];
    if (brightness(exitance) > 0) lamps_.push_back({{scene, ray_scene, emitter}, emitter.primitive, exitance});
  }
}

void PixelLight::add(std::vector<ShadingPoint>& points, int width, std::uint64_t seed, std::span<Color> pixels) const {
  if (lamps_.empty() || points.empty()) return;
  std::stable_sort(points.begin(), points.end(), [](const ShadingPoint& a, const ShadingPoint& b) {
    return std::pair(a.pixel, a.primitive) < std::pair(b.pixel, b.primitive);
  });
  std::vector<Spot> spots;
  for (std::size_t first = 0, k = 1; k <= points.size(); ++k) {
    if (k < points.size() && points[k].pixel == points[first].pixel && points[k].primitive == points[first].primitive &&
        (points[k].normal ^ points[first].normal) > kAlike)
      continue;
    spots.emplace_back(std::span(points).subspan(first, k - first));
    first = k;
  }
  Tile(*this, spots, width, seed, pixels).add_lamps();
}

}  // namespace patchlight

#include "tracer/light/integrator.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <atomic>
#include <utility>

#include "pipeline/frames/light_settings.h"
#include "tracer/sampling/pixel_samples.h"

namespace patchlight {

namespace {

constexpr int kTile = 32;                     // pixels along a tile's edge
constexpr int kMostAtFirst = 64;              // samples of a pixel that all wait for its neighbours'
constexpr std::size_t kManyPoints = 1 << 16;  // that wait for direct light, after which no other pixel's shall
constexpr std::size_t kMostPoints = 1 << 18;  // nor any more of this pixel's
constexpr float kSlack = 1.02f;  // how much farther than all about it an edge may seem to be, and still be seen

}  // namespace

SampleCounts::SampleCounts(int samples)
    : few(std::min(samples, std::max(4, samples / 4))),
      some(samples),
      edge(samples > 1 ? 4 * samples : 1),
      first(std::min(few, kMostAtFirst)) {}

/// A tile of a frame and, where they are compared with its own, a margin of one pixel about it.
class Integrator::Tile {
 public:
  Tile(const Integrator& integrator, const CameraRays& rays, const std::vector<float>& outlines, int x0, int y0,
       Image& image)
      : frame_(integrator),
        rays_(rays),
        outlines_(outlines),
        image_(image),
        x0_(x0),
        y0_(y0),
        x1_(std::min(x0 + kTile, image.width)),
        y1_(std::min(y0 + kTile, image.height)),
        compared_(!integrator.counts_.even() || integrator.lights_),
        window_{std::max(0, x0 - compared_), std::max(0, y0 - compared_), 0, 0} {
    window_.width = std::min(x1_ + compared_, image.width) - window_.x0;
    window_.height = std::min(y1_ + compared_, image.height) - window_.y0;
    const auto pixels = std::size_t(window_.pixels());
    sums_.pixels.assign(pixels, Color(0.0f));
    if (!frame_.counts_.even()) sums_.details.resize(pixels);
    sums_.window = &window_;
    if (!image.layers.empty()) sums_.layers = &layers_.emplace(frame_.config_, frame_.scene_, pixels);
  }

  void render() {
    const SampleCounts& counts = frame_.counts_;
    for (std::uint32_t p = 0; p < std::uint32_t(window_.pixels()); ++p) add_samples(p, 0, counts.first);
    finish_paths();
    const std::vector<PixelDetail> details = std::exchange(sums_.details, {});
    std::vector<ShadingPoint> points = std::exchange(sums_.points, {});
    std::vector<int> samples(std::size_t(window_.pixels()), counts.first);
    smooth_.assign(std::size_t(window_.pixels()), 0);
    for_each_pixel([&](int x, int y, std::uint32_t p) {
      if (!counts.even()) samples[p] = samples_at(details, x, y);
      smooth_[p] = counts.even() || samples[p] < counts.edge;
    });
    if (frame_.lights_)
      light_.emplace(*frame_.lights_, window_, counts.some, sums_.layers).look(std::move(points), smooth_);
    for_each_pixel([&](int, int, std::uint32_t p) {
      if (light_ && (smooth_[p] == 0 || light_->sharp(p))) {
        samples[p] = std::max(samples[p], counts.some);
        smooth_[p] = 0;
      }
      if (light_) add_first_points(p);
      add_samples(p, counts.first, samples[p]);
      if (sums_.points.size() > kManyPoints) add_light();
    });
    add_light();
    for_each_pixel([&](int x, int y, std::uint32_t p) {
      const std::size_t at = std::size_t(y) * image_.width + x;
      image_.pixels[at] = sums_.pixels[p] / float(samples[p]);
      if (layers_) layers_->put(p, samples[p], at, image_.layers);
    });
  }

  /// Rays cast from the camera.
  std::int64_t cast() const { return cast_; }

 private:
  /// Not of the margin.
  bool is_own(std::uint32_t p) const {
    const int x = window_.x0 + int(p) % window_.width, y = window_.y0 + int(p) / window_.width;
    return x >= x0_ && x < x1_ && y >= y0_ && y < y1_;
  }

  std::uint32_t pixel(int x, int y) const { return std::uint32_t((y - window_.y0) * window_.width + x - window_.x0); }

  /// Samples `from` to `to` of a pixel.
  void add_samples(std::uint32_t p, int from, int to) {
    const std::uint64_t seed = hash64(window_.place(p));
    const int x = window_.x0 + int(p) % window_.width, y = window_.y0 + int(p) / window_.width;
    for (int k = from; k < to; ++k) {
      const Vec2f at = pixel_sample(std::uint32_t(k), seed);
      points_.x[lane_] = float(x) + at.x;
      points_.y[lane_] = float(y) + at.y;
      going_[lane_] = {p, std::uint32_t(k), layers_ ? (at - Vec2f(0.5f)).length2() : 0.0f};
      if (++lane_ < RayPacket::kSize) continue;
      finish_paths();
      if (light_ && sums_.points.size() > kMostPoints) add_light();
    }
  }

  void finish_paths() {
    cast_ += lane_;
    if (lane_ > 0) {
      RayPacket packet;
      rays_.start(points_, frame_.ray_scene_, packet);
      for (int lane = lane_; lane < RayPacket::kSize; ++lane) packet.valid[lane] = 0;
      frame_.paths_.trace(packet, going_, rays_, sums_);
    }
    lane_ = 0;
    if (sums_.gather.empty()) return;
    std::erase_if(sums_.gather, [&](const GatherPoint& point) { return !is_own(point.at.pixel); });
    frame_.gather_->add(sums_.gather, window_, sums_.pixels, sums_.layers);
    sums_.gather.clear();
  }

  void add_first_points(std::uint32_t p) {
    const std::span<const ShadingPoint> first = light_->points(p);
    if (smooth_[p] == 0)
      sums_.points.insert(sums_.points.end(), first.begin(), first.end());
    else
      for (const ShadingPoint& point : first) light_->add_seen(point, sums_.pixels);
  }

  /// Finishes all paths, and adds light to where they lead.
  void add_light() {
    finish_paths();
    if (!light_) return;
    std::erase_if(sums_.points, [&](const ShadingPoint& point) {
      return smooth_[point.pixel] != 0 && light_->add_seen(point, sums_.pixels);
    });
    light_->add(sums_.points, sums_.pixels);
    sums_.points.clear();
  }

  template <typename Function>
  void for_each_pixel(Function&& function) const {
    for (int y = y0_; y < y1_; ++y)
      for (int x = x0_; x < x1_; ++x) function(x, y, pixel(x, y));
  }

  /// Whether the nearest edge in a pixel is seen, if nothing about it is farther than `farthest`.
  bool outlined(int x, int y, float farthest) const {
    return outlines_[std::size_t(y) * image_.width + x] <= farthest * kSlack;
  }

  int samples_at(const std::vector<PixelDetail>& details, int x, int y) const {
    PixelDetail around;
    float farthest = details[pixel(x, y)].farthest();
    for (int v = std::max(0, y - 1); v <= std::min(image_.height - 1, y + 1); ++v)
      for (int u = std::max(0, x - 1); u <= std::min(image_.width - 1, x + 1); ++u) {
        if (u == x && v == y) continue;
        const PixelDetail& other = details[pixel(u, v)];
        farthest = std::max(farthest, other.farthest());
        if (!outlined(u, v, other.farthest())) around.add(other);  // else it is known why its samples differ
      }
    const PixelDetail::Level level = around.level();
    if (level == PixelDetail::Level::edge || outlined(x, y, farthest)) return frame_.counts_.edge;
    return level == PixelDetail::Level::some ? frame_.counts_.some : frame_.counts_.few;
  }

  const Integrator& frame_;
  const CameraRays& rays_;
  const std::vector<float>& outlines_;
  Image& image_;
  const int x0_, y0_, x1_, y1_;
  const bool compared_;  ///< Pixels are, with their neighbours: so tiles have margins.
  TileLight::Window window_;
  std::vector<std::uint8_t> smooth_;  ///< By pixel: all of it gets as much direct light as its first samples do.
  std::optional<LayerSums> layers_;
  std::optional<TileLight> light_;
  PathSums sums_;
  ImagePoints points_;  ///< That paths are to start through.
  std::array<PathTracer::Path, RayPacket::kSize> going_;
  int lane_ = 0;
  std::int64_t cast_ = 0;
};

Integrator::Integrator(const PatchSet& scene, const EnergyField& energy, const Job& job)
    : scene_(scene),
      config_(job.trace),
      counts_(config_.samples),
      ray_scene_(scene),
      outlines_(scene),
      mixes_(light_settings(job, scene), config_.asks_for("light_groups")),
      surfaces_(scene, ray_scene_, energy, mixes_, config_),
      paths_(scene, ray_scene_, outlines_, surfaces_, mixes_, config_) {
  if (config_.quality != "patches") lights_.emplace(scene, ray_scene_, mixes_.all[0]);
  if (config_.quality == "gather") gather_.emplace(scene, ray_scene_, surfaces_, mixes_, config_.gather_rays);
}

Image Integrator::render(const Camera& camera, Progress& progress) const {
  const auto [width, height] = config_.resolution;
  const std::size_t pixels = std::size_t(width) * height;
  Image image{width, height, std::vector<Color>(pixels, Color(0.0f)), {}, LayerSums::blank(config_, scene_, pixels)};
  const CameraRays rays(camera, width, height);
  const std::vector<float> outlines = counts_.even() ? std::vector<float>() : outlines_.draw(rays, width, height);
  const int across = (width + kTile - 1) / kTile, down = (height + kTile - 1) / kTile;
  std::atomic<std::int64_t> cast = 0;
  constexpr int kRowsAtOnce = 2;  // of tiles, between two looks at the signals
  for (int first = 0; first < down; first += kRowsAtOnce) {
    const int count = std::min(kRowsAtOnce, down - first) * across;
    tbb::parallel_for(0, count, [&](int index) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
      Tile tile(*this, rays, outlines, index % across * kTile, (first + index / across) * kTile, image);
      tile.render();
      cast += tile.cast();
    });
    progress.update(double(first + 1) / down, camera.name, cast);
  }
  return image;
}

}  // namespace patchlight

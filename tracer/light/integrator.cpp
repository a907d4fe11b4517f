#include "tracer/light/integrator.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>

#include "pipeline/frames/light_settings.h"
#include "pipeline/job/frame_size.h"
#include "tracer/sampling/pixel_samples.h"

namespace patchlight {

namespace {

constexpr int kTileSize = 32;                 // pixels along a tile's edge
constexpr int kMaxInitialSamples = 64;        // of a pixel
constexpr std::size_t kManyPoints = 1 << 16;  // pending shading points that are flushed after a pixel
constexpr std::size_t kMaxPoints = 1 << 18;   // pending shading points that are flushed within a pixel
constexpr float kDepthTolerance = 1.02f;      // depth of a visible edge over the depth of the surfaces around it

}  // namespace

SampleCounts::SampleCounts(int samples)
    : smooth(std::min(samples, std::max(4, samples / 4))),
      detail(samples),
      edge(samples > 1 ? 4 * samples : 1),
      initial(std::min(smooth, kMaxInitialSamples)) {}

/// A tile of a frame and, if neighbouring pixels are compared, a margin of one pixel around it.
class Integrator::Tile {
 public:
  Tile(const Integrator& integrator, const CameraRays& rays, const std::vector<float>& outlines, int x0, int y0,
       Image& image)
      : integrator_(integrator),
        rays_(rays),
        outlines_(outlines),
        image_(image),
        x0_(x0),
        y0_(y0),
        x1_(std::min(x0 + kTileSize, image.width)),
        y1_(std::min(y0 + kTileSize, image.height)),
        has_margin_(!integrator.counts_.uniform() || integrator.direct_),
        window_{std::max(0, x0 - has_margin_), std::max(0, y0 - has_margin_), 0, 0} {
    window_.width = std::min(x1_ + has_margin_, image.width) - window_.x0;
    window_.height = std::min(y1_ + has_margin_, image.height) - window_.y0;
    const auto pixels = std::size_t(window_.pixels());
    sums_.pixels.assign(pixels, Color(0.0f));
    if (!integrator_.counts_.uniform()) sums_.details.resize(pixels);
    sums_.window = &window_;
    sums_.first_samples = std::uint32_t(integrator_.counts_.initial);
    if (!image.layers.empty()) sums_.layers = &layers_.emplace(integrator_.config_, integrator_.scene_, pixels);
  }

  void render() {
    const SampleCounts& counts = integrator_.counts_;
    for (std::uint32_t p = 0; p < std::uint32_t(window_.pixels()); ++p) add_samples(p, 0, counts.initial);
    trace_pending();
    const std::vector<PixelDetail> details = std::exchange(sums_.details, {});
    std::vector<ShadingPoint> points = std::exchange(sums_.points, {});
    std::vector<int> samples(std::size_t(window_.pixels()), counts.initial);
    probed_.assign(std::size_t(window_.pixels()), 0);
    for_each_pixel([&](int x, int y, std::uint32_t p) {
      if (!counts.uniform()) samples[p] = samples_at(details, x, y);
      probed_[p] = counts.uniform() || samples[p] < counts.edge;
    });
    if (integrator_.direct_)
      light_.emplace(*integrator_.lights_, *integrator_.further_, window_, counts.detail, sums_.layers)
          .probe(std::move(points), probed_);
    for_each_pixel([&](int, int, std::uint32_t p) {
      if (light_ && (probed_[p] == 0 || light_->sharp(p))) {
        samples[p] = std::max(samples[p], counts.detail);
        probed_[p] = 0;
      }
      if (light_) add_initial_points(p);
      add_samples(p, counts.initial, samples[p]);
      if (sums_.points.size() > kManyPoints) add_pending_light();
    });
    add_pending_light();
    if (rays_.has_lens() && layers_ && layers_->has_surfaces()) trace_central_rays();
    for_each_pixel([&](int x, int y, std::uint32_t p) {
      const std::size_t at = std::size_t(y) * image_.width + x;
      image_.pixels[at] = sums_.pixels[p] / float(samples[p]);
      if (layers_) layers_->resolve(p, samples[p], at, image_.layers);
    });
  }

  /// Number of camera rays.
  std::int64_t rays_cast() const { return rays_cast_; }

 private:
  /// Whether a pixel lies in the tile itself, not in the margin.
  bool is_inside(std::uint32_t p) const {
    const int x = window_.x0 + int(p) % window_.width, y = window_.y0 + int(p) / window_.width;
    return x >= x0_ && x < x1_ && y >= y0_ && y < y1_;
  }

  std::uint32_t pixel(int x, int y) const { return std::uint32_t((y - window_.y0) * window_.width + x - window_.x0); }

  /// Traces samples `from` to `to - 1` of a pixel.
  void add_samples(std::uint32_t p, int from, int to) {
    const std::uint64_t seed = hash64(window_.pixel_id(p));
    const int x = window_.x0 + int(p) % window_.width, y = window_.y0 + int(p) / window_.width;
    for (int k = from; k < to; ++k) {
      const Vec2f at = pixel_sample(std::uint32_t(k), seed);
      points_.x[lane_] = float(x) + at.x;
      points_.y[lane_] = float(y) + at.y;
      paths_[lane_] = {p, std::uint32_t(k), layers_ ? (at - Vec2f(0.5f)).length2() : 0.0f};
      if (rays_.has_lens()) {
        points_.lens[lane_] = lens_sample(std::uint32_t(k), seed);
        paths_[lane_].center_distance2 = std::numeric_limits<float>::infinity();
      }
      if (++lane_ < RayPacket::kSize) continue;
      trace_pending();
      if (light_ && sums_.points.size() > kMaxPoints) add_pending_light();
    }
  }

  /// Traces a ray through the centres of each pixel and of the lens, which layers show that are no mean over samples.
  void trace_central_rays() {
    for_each_pixel([&](int x, int y, std::uint32_t p) {
      points_.x[lane_] = float(x) + 0.5f;
      points_.y[lane_] = float(y) + 0.5f;
      points_.lens[lane_] = Vec2f(0.0f);
      paths_[lane_] = {p};
      paths_[lane_].central = true;
      if (++lane_ == RayPacket::kSize) trace_pending();
    });
    trace_pending();
  }

  void trace_pending() {
    rays_cast_ += lane_;
    if (lane_ > 0) {
      RayPacket packet;
      rays_.generate(points_, integrator_.ray_scene_, packet);
      for (int lane = lane_; lane < RayPacket::kSize; ++lane) packet.valid[lane] = 0;
      integrator_.paths_->trace(packet, paths_, rays_, sums_);
    }
    lane_ = 0;
    if (sums_.gather.empty()) return;
    std::erase_if(sums_.gather, [&](const GatherPoint& point) { return !is_inside(point.shading.pixel); });
    integrator_.gather_->add(sums_.gather, window_, sums_.pixels, sums_.layers);
    sums_.gather.clear();
  }

  void add_initial_points(std::uint32_t p) {
    const std::span<const ShadingPoint> first = light_->points(p);
    if (probed_[p] == 0)
      sums_.points.insert(sums_.points.end(), first.begin(), first.end());
    else
      for (const ShadingPoint& point : first) light_->add_probed(point, sums_.pixels);
  }

  /// Traces pending paths, then adds the direct light of the pending shading points.
  void add_pending_light() {
    trace_pending();
    if (!light_) return;
    std::erase_if(sums_.points, [&](const ShadingPoint& point) {
      return probed_[point.pixel] != 0 && light_->add_probed(point, sums_.pixels);
    });
    light_->add(sums_.points, sums_.pixels);
    sums_.points.clear();
  }

  template <typename Function>
  void for_each_pixel(Function&& function) const {
    for (int y = y0_; y < y1_; ++y)
      for (int x = x0_; x < x1_; ++x) function(x, y, pixel(x, y));
  }

  /// Whether the nearest edge in a pixel is visible, given the largest depth of the surfaces around it.
  bool has_visible_edge(int x, int y, float max_depth) const {
    return outlines_[std::size_t(y) * image_.width + x] <= max_depth * kDepthTolerance;
  }

  int samples_at(const std::vector<PixelDetail>& details, int x, int y) const {
    PixelDetail around;
    float max_depth = details[pixel(x, y)].max_depth();
    for (int v = std::max(0, y - 1); v <= std::min(image_.height - 1, y + 1); ++v)
      for (int u = std::max(0, x - 1); u <= std::min(image_.width - 1, x + 1); ++u) {
        if (u == x && v == y) continue;
        const PixelDetail& other = details[pixel(u, v)];
        max_depth = std::max(max_depth, other.max_depth());
        if (!has_visible_edge(u, v, other.max_depth()))
          around.add(other);  // a visible edge explains the difference of its samples
      }
    const PixelDetail::Level level = around.level();
    if (level == PixelDetail::Level::edge || has_visible_edge(x, y, max_depth)) return integrator_.counts_.edge;
    return level == PixelDetail::Level::detail ? integrator_.counts_.detail : integrator_.counts_.smooth;
  }

  const Integrator& integrator_;
  const CameraRays& rays_;
  const std::vector<float>& outlines_;
  Image& image_;
  const int x0_, y0_, x1_, y1_;
  const bool has_margin_;  ///< Pixels are compared with their neighbours.
  TileWindow window_;
  std::vector<std::uint8_t> probed_;  ///< [pixels]: direct light is that of the probes from the initial samples.
  std::optional<LayerSums> layers_;
  std::optional<TileLight> light_;
  PathSums sums_;
  ImagePoints points_;  ///< Of pending camera rays.
  std::array<PathTracer::Path, RayPacket::kSize> paths_;
  int lane_ = 0;
  std::int64_t rays_cast_ = 0;
};

Integrator::Integrator(const PatchSet& scene, const EnergyField& energy, const Job& job)
    : scene_(scene),
      energy_(energy),
      config_(job.trace),
      counts_(config_.samples),
      smooth_(scene.primitives),
      ray_scene_(scene),
      outlines_(scene, smooth_),
      direct_(config_.quality != "patches") {
  set_lights(light_settings(job, scene, 1));
}

void Integrator::set_lights(const std::vector<Color>& settings) {
  if (mixes_ && settings == settings_) return;
  settings_ = settings;
  mixes_.emplace(settings, config_.asks_for("light_groups"));
  surfaces_.emplace(scene_, energy_, *mixes_, config_, smooth_);
  const bool glossy = GlossyLights::is_needed(scene_);
  if (direct_ || glossy) {
    lights_.emplace(scene_, ray_scene_, mixes_->all[0]);
    further_.emplace(scene_, ray_scene_, mixes_->all[0]);
  }
  if (glossy) glossy_lights_.emplace(scene_, ray_scene_, *lights_, *further_);
  paths_.emplace(scene_, ray_scene_, outlines_, *surfaces_, *mixes_, glossy ? &*glossy_lights_ : nullptr, config_);
  if (config_.quality == "gather") gather_.emplace(scene_, ray_scene_, *surfaces_, *mixes_, config_.gather_rays);
}

Image Integrator::render(const Camera& camera, Progress& progress) const {
  const auto [width, height] = frame_size(config_, camera);
  const std::size_t pixels = std::size_t(width) * height;
  Image image{width, height, std::vector<Color>(pixels, Color(0.0f)), {}, LayerSums::blank(config_, scene_, pixels)};
  const CameraRays rays(camera, width, height);
  const std::vector<float> outlines = counts_.uniform() ? std::vector<float>() : outlines_.draw(rays, width, height);
  const int across = (width + kTileSize - 1) / kTileSize, down = (height + kTileSize - 1) / kTileSize;
  std::atomic<std::int64_t> rays_cast = 0;
  constexpr int kRowsAtOnce = 2;  // of tiles, between two progress updates
  for (int first = 0; first < down; first += kRowsAtOnce) {
    const int count = std::min(kRowsAtOnce, down - first) * across;
    tbb::parallel_for(0, count, [&](int index) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
      Tile tile(*this, rays, outlines, index % across * kTileSize, (first + index / across) * kTileSize, image);
      tile.render();
      rays_cast += tile.rays_cast();
    });
    progress.update(double(first + 1) / down, camera.name, rays_cast);
  }
  return image;
}

}  // namespace patchlight

#include "tracer/sampling/outline_canvas.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace patchlight {

namespace {

constexpr double kNearClip = 1e-4;   // depth at which an edge is clipped, over its largest depth
constexpr double kLevelRatio = 1.5;  // of the blur of two levels
constexpr float kNone = std::numeric_limits<float>::infinity();

int margin_of(const CameraRays& rays, int width, int height) {
  return rays.has_lens() ? std::min(OutlineCanvas::kMaxMargin, std::max(width, height) / 4 + 1) : 0;
}

/// Radius in pixels by which edges of a level are widened.
int radius_of(int level) {
  return level == 0 ? 0 : int(std::ceil(0.5 * std::pow(kLevelRatio, level)));
}

/// Minimum over `size` values from each place on; values past the end count as none. `line` is used up.
void minimum_ahead(std::vector<float>& line, std::size_t size) {
  std::size_t done = 1;
  const auto combine = [&](std::size_t step) {
    for (std::size_t i = 0; i + step < line.size(); ++i) line[i] = std::min(line[i], line[i + step]);
  };
  for (; 2 * done <= size; done *= 2) combine(done);
  if (done < size) combine(size - done);
}

/// Replaces each value by the minimum over a square of 2 `radius` + 1 values around it.
void widen(std::vector<float>& values, int width, int height, int radius) {
  const auto along = [&](int lines, int length, std::size_t line_step, std::size_t step) {
    tbb::parallel_for(0, lines, [&](int k) {
      std::vector<float> line(std::size_t(length) + std::size_t(radius), kNone);
      float* const first = values.data() + std::size_t(k) * line_step;
      for (int i = 0; i < length; ++i) line[std::size_t(i) + std::size_t(radius)] = first[std::size_t(i) * step];
      minimum_ahead(line, 2 * std::size_t(radius) + 1);
      for (int i = 0; i < length; ++i) first[std::size_t(i) * step] = line[std::size_t(i)];
    });
  };
  along(height, width, std::size_t(width), 1);
  along(width, height, 1, std::size_t(width));
}

}  // namespace

OutlineCanvas::OutlineCanvas(const CameraRays& camera_rays, int width, int height)
    : rays(camera_rays),
      margin_(margin_of(camera_rays, width, height)),
      width_(width + 2 * margin_),
      height_(height + 2 * margin_) {}

int OutlineCanvas::level_of(float depth) const {
  if (!rays.has_lens()) return 0;
  const double radius = std::min(0.5 * rays.blur(depth) / rays.pixel_size(depth), double(margin_));
  return radius <= 0.5 ? 0 : std::max(0, int(std::ceil(std::log(2 * radius) / std::log(kLevelRatio))));
}

std::vector<float>& OutlineCanvas::plane(int level) {
  if (planes_.size() <= std::size_t(level)) planes_.resize(std::size_t(level) + 1);
  std::vector<float>& plane = planes_[std::size_t(level)];
  if (plane.empty()) plane.assign(std::size_t(width_) * height_, kNone);
  return plane;
}

void OutlineCanvas::draw_line(Vec3d a, Vec3d b) {
  if (a.z > b.z) std::swap(a, b);  // b is nearer
  if (!(a.z < 0) || rays.clips(-b.z, -a.z)) return;
  const double nearest = rays.perspective() ? kNearClip * a.z : 0.0;
  if (b.z > nearest) b = a + (b - a) * ((nearest - a.z) / (b.z - a.z));
  const Vec2d p = rays.to_image(a) + Vec2d(margin_), q = rays.to_image(b) + Vec2d(margin_);
  // 1 / depth is linear along a line in the image; in parallel projection depth itself is.
  const double at_p = rays.perspective() ? -1 / a.z : -a.z, at_q = rays.perspective() ? -1 / b.z : -b.z;
  const bool horizontal = std::abs(q.x - p.x) >= std::abs(q.y - p.y);
  const auto along = [&](const Vec2d& v) { return horizontal ? v.x : v.y; };
  const auto across = [&](const Vec2d& v) { return horizontal ? v.y : v.x; };
  const double low = std::min(along(p), along(q)), high = std::max(along(p), along(q));
  const int steps = horizontal ? width_ : height_, rows = horizontal ? height_ : width_;
  if (!(high >= 0 && low < steps)) return;
  const double length = along(q) - along(p);
  for (int step = int(std::max(0.0, std::floor(low))); step < steps && step <= high; ++step) {
    const auto parameter = [&](double x) { return length != 0 ? std::clamp((x - along(p)) / length, 0.0, 1.0) : 0.0; };
    const double s = parameter(step), t = length != 0 ? parameter(step + 1) : 1.0;
    const double from = across(p) + (across(q) - across(p)) * s, to = across(p) + (across(q) - across(p)) * t;
    const double v = at_p + (at_q - at_p) * s, w = at_p + (at_q - at_p) * t;
    const auto depth = float(rays.perspective() ? 1 / std::max(v, w) : std::min(v, w));
    const double first = std::max(0.0, std::floor(std::min(from, to)));
    const double last = std::min(double(rows - 1), std::floor(std::max(from, to)));
    if (first > last) continue;
    std::vector<float>& depths = plane(level_of(depth));
    for (int row = int(first); row <= last; ++row) {
      float& nearest_edge =
          horizontal ? depths[std::size_t(row) * width_ + step] : depths[std::size_t(step) * width_ + row];
      nearest_edge = std::min(nearest_edge, depth);
    }
  }
}

std::vector<float> OutlineCanvas::depths() {
  if (margin_ == 0) return std::move(plane(0));
  const int width = width_ - 2 * margin_, height = height_ - 2 * margin_;
  std::vector<float> nearest(std::size_t(width) * height, kNone);
  for (std::size_t level = 0; level < planes_.size(); ++level) {
    std::vector<float> edges = std::move(planes_[level]);
    if (edges.empty()) continue;
    if (level > 0) widen(edges, width_, height_, radius_of(int(level)));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        float& depth = nearest[std::size_t(y) * width + x];
        depth = std::min(depth, edges[std::size_t(y + margin_) * width_ + std::size_t(x + margin_)]);
      }
  }
  return nearest;
}

}  // namespace patchlight

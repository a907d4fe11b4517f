#include "solver/display/sectors.h"

#include <algorithm>
#include <cmath>

#include "pipeline/model/cuts/polygon.h"

namespace patchlight {

namespace {

/// Appends the angles in which a line passes through or ends at a point.
void add_rays(const Vec2d& point, const Vec2d& from, const Vec2d& to, double tolerance, std::vector<double>& rays) {
  const Vec2d along = to - from;
  const double length = along.length();
  if (length == 0 || std::abs(side_of(from, to, point)) > tolerance * length) return;
  const double t = ((point - from) ^ along) / length;
  if (t < -tolerance || t > length + tolerance) return;
  if (t < length - tolerance) rays.push_back(std::atan2(along.y, along.x));
  if (t > tolerance) rays.push_back(std::atan2(-along.y, -along.x));
}

}  // namespace

int Sectors::of(const Vec2d& direction) const {
  if (rays.empty()) return 0;
  const double angle = std::atan2(direction.y, direction.x);
  return int((std::upper_bound(rays.begin(), rays.end(), angle) - rays.begin()) % std::ptrdiff_t(rays.size()));
}

Vec2d Sectors::middle(int sector) const {
  const double to = rays[std::size_t(sector)];
  const double from = sector > 0 ? rays[std::size_t(sector) - 1] : rays.back() - 2 * kPi;
  return {std::cos(0.5 * (from + to)), std::sin(0.5 * (from + to))};
}

SectorFinder::SectorFinder(const Primitive& primitive, const PlaneFrame& frame, double tolerance)
    : tolerance_(tolerance) {
  for (int k = 0; k < 4; ++k)
    outline_.push_back({frame.to_plane(primitive.corners[k]), frame.to_plane(primitive.corners[(k + 1) % 4])});
}

Sectors SectorFinder::around(const Vec2d& point, std::span<const Crossing> crossings) const {
  constexpr double kSame = 1e-6;  // rad
  Sectors sectors{point, {}, 0};
  std::vector<double>& rays = sectors.rays;
  for (const Crossing& crossing : crossings) {
    const std::size_t before = rays.size();
    add_rays(point, crossing.from, crossing.to, tolerance_, rays);
    if (rays.size() > before) sectors.height = std::max(sectors.height, crossing.height);
  }
  if (rays.empty()) return sectors;
  for (const auto& [from, to] : outline_) add_rays(point, from, to, tolerance_, rays);
  std::sort(rays.begin(), rays.end());
  rays.erase(std::unique(rays.begin(), rays.end(), [](double a, double b) { return b - a < kSame; }), rays.end());
  if (rays.size() > 1 && rays.front() + 2 * kPi - rays.back() < kSame) rays.pop_back();
  return sectors;
}

}  // namespace patchlight

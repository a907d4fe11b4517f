#include "solver/display/seams.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/model/cuts/cut_cells.h"
#include "pipeline/optics/cuts/box_tree.h"
#include "pipeline/optics/cuts/cell_cutter.h"

namespace patchlight {

namespace {

constexpr double kSameNormal = 1e-6;           // 1 - cosine
constexpr double kRounding = 1.0 / (1 << 22);  // of positions, relative to their coordinates

/// A quad that may go on in others.
struct Candidate {
  std::int32_t primitive;
  PlaneFrame frame;
  double rounding;  ///< m
};

double distance_from_line(const Vec2d& a, const Vec2d& b, const Vec2d& p) {
  return std::abs(side_of(a, b, p)) / (b - a).length();
}

}  // namespace

Seams::Seams(const PatchSet& scene, const Lattices& lattices, const std::vector<double>& reach,
             const std::vector<std::vector<Crossing>>& at_edges)
    : scene_(scene), has_(scene.primitives.size()), lines_(scene.primitives.size()), at_edges_(at_edges) {
  std::vector<Candidate> candidates;
  std::vector<Imath::Box3d> boxes;
  for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) {
    const std::optional<PlaneFrame> frame = reach[i] < 0 ? std::nullopt : PlaneFrame::of(scene.primitives[i]);
    if (!frame) continue;
    Imath::Box3d& box = boxes.emplace_back(bounds_of({scene.primitives[i]}));
    double largest = 0;
    for (int k = 0; k < 3; ++k) largest = std::max({largest, -box.min[k], box.max[k]});
    candidates.push_back({i, *frame, position_rounding(scene.primitives[i]) + kRounding * largest});
    box.min -= Vec3d(candidates.back().rounding);
    box.max += Vec3d(candidates.back().rounding);
  }
  const BoxTree tree(boxes);
  const auto add = [&](const Candidate& of, const Candidate& other) {
    const Primitive &p = scene.primitives[of.primitive], &q = scene.primitives[other.primitive];
    const double rounding = of.rounding + other.rounding;
    if ((of.frame.normal() ^ other.frame.normal()) < 1 - kSameNormal || of.primitive == other.primitive) return;
    for (const Vec3d& corner : q.corners)
      if (std::abs(of.frame.height(corner)) > rounding) return;
    for (int k = 0; k < 4; ++k) {
      const Vec2d a = of.frame.to_plane(p.corners[k]), b = of.frame.to_plane(p.corners[(k + 1) % 4]);
      const double length = (b - a).length();
      if (length <= 4 * rounding) continue;
      for (int m = 0; m < 4; ++m) {
        // Both run counter-clockwise, so that quads on both sides have opposite edges.
        const Vec2d c = of.frame.to_plane(q.corners[(m + 1) % 4]), d = of.frame.to_plane(q.corners[m]);
        if (distance_from_line(a, b, c) > rounding || distance_from_line(a, b, d) > rounding) continue;
        const double from = std::max(0.0, ((c - a) ^ (b - a)) / length);
        const double to = std::min(length, ((d - a) ^ (b - a)) / length);
        if (to - from > 4 * rounding)
          lines_[of.primitive].push_back({a + (b - a) * (from / length), a + (b - a) * (to / length)});
      }
    }
  };
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const std::int32_t lattice = lattices.frame(candidates[k].primitive).lattice;
    std::vector<std::int32_t> near = tree.overlapping(boxes[k]);
    std::sort(near.begin(), near.end());
    for (const std::int32_t other : near)
      if (lattices.frame(candidates[other].primitive).lattice != lattice) add(candidates[k], candidates[other]);
    has_[candidates[k].primitive] = !lines_[candidates[k].primitive].empty();
  }
  for (const auto& quads : lattices.quads())
    if (std::any_of(quads.begin(), quads.end(), [&](std::int32_t i) { return has_[i]; }))
      for (const std::int32_t i : quads) has_[i] = true;
  for (const Candidate& candidate : candidates)
    if (has_[candidate.primitive]) rounding_ = std::max(rounding_, candidate.rounding);
}

bool Seams::touches(const Patch& cell) const {
  if (lines_[cell.primitive].empty()) return false;
  const Primitive& primitive = scene_.primitives[cell.primitive];
  const Polygon polygon = cell_polygon(primitive, *PlaneFrame::of(primitive), cell);
  const double rounding = position_rounding(primitive);
  return std::any_of(lines_[cell.primitive].begin(), lines_[cell.primitive].end(), [&](const Line& line) {
    Vec2d a = line.from, b = line.to;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vec2d &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
      const double length = (q - p).length();
      const double inside_a = side_of(p, q, a) / length + rounding, inside_b = side_of(p, q, b) / length + rounding;
      if (inside_a < 0 && inside_b < 0) return false;
      if (inside_a < 0) a += (b - a) * (inside_a / (inside_a - inside_b));
      if (inside_b < 0) b += (a - b) * (inside_b / (inside_b - inside_a));
    }
    return true;
  });
}

bool Seams::is_open(std::int32_t i, const Vec2d& point) const {
  const double tolerance = 2 * position_rounding(scene_.primitives[i]);
  return std::none_of(at_edges_[i].begin(), at_edges_[i].end(), [&](const Crossing& crossing) {
    const Vec2d along = (crossing.to - crossing.from).normalized();
    const double t = (point - crossing.from) ^ along;
    return t > -tolerance && t < (crossing.to - crossing.from).length() + tolerance &&
           distance_from_line(crossing.from, crossing.to, point) <= tolerance;
  });
}

std::int32_t SharedPoints::number(const Vec3d& point, const Vec3d& normal, double tolerance) {
  const auto region = [&](const Vec3d& p) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) key = hash64(key ^ std::uint64_t(std::int64_t(std::floor(p[k] / (4 * rounding_)))));
    return key;
  };
  std::array<std::uint64_t, 8> regions;
  for (int k = 0; k < 8; ++k)
    regions[k] = region(point + Vec3d(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1) * rounding_);
  std::sort(regions.begin(), regions.end());
  std::int32_t nearest = -1;
  double distance = tolerance;
  for (auto key = regions.begin(), last = std::unique(regions.begin(), regions.end()); key != last; ++key)
    for (auto [at, end] = by_region_.equal_range(*key); at != end; ++at) {
      const Point& other = points_[at->second];
      if ((other.at - point).length() > distance || (other.normal ^ normal) < 1 - kSameNormal) continue;
      distance = (other.at - point).length();
      nearest = at->second;
    }
  if (nearest >= 0) return nearest;
  by_region_.emplace(region(point), std::int32_t(points_.size()));
  points_.push_back({point, normal});
  return std::int32_t(points_.size()) - 1;
}

}  // namespace patchlight

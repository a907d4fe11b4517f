#include "pipeline/optics/cuts/cell_cutter.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

/// Distance of p to the left of the line from a to b.
double distance(const Vec2d& a, const Vec2d& b, const Vec2d& p) {
  return side_of(a, b, p) / (b - a).length();
}

Imath::Box2d box_of(std::span<const Vec2d> points) {
  Imath::Box2d box;
  for (const Vec2d& p : points) box.extendBy(p);
  return box;
}

/// The part of a segment inside of a convex polygon; its ends are equal if there is none.
std::array<Vec2d, 2> clipped(std::array<Vec2d, 2> segment, const Polygon& polygon) {
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2d &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    auto& [a, b] = segment;
    const double inside_a = side_of(p, q, a), inside_b = side_of(p, q, b);
    if (inside_a <= 0 && inside_b <= 0) return {a, a};
    if (inside_a < 0) a += (b - a) * (inside_a / (inside_a - inside_b));
    if (inside_b < 0) b += (a - b) * (inside_b / (inside_b - inside_a));
  }
  return segment;
}

/// The tree of lines of one cell while it is cut.
class Cutting {
 public:
  Cutting(const Polygon& cell, double thinnest) : thinnest_(thinnest) { result_.parts = {cell}; }

  void add(const std::array<Vec2d, 2>& segment) {
    if (result_.cuts.empty()) {
      cut_part(0, segment, nullptr);
    } else {
      add(0, segment);
    }
  }

  CellParts result() && {
    for (std::size_t part = 0; part < result_.parts.size(); ++part)
      while (result_.parts[part].size() > CellCutter::kMostCorners) halve(std::int32_t(part));
    return std::move(result_);
  }

 private:
  void add(std::int32_t line, std::array<Vec2d, 2> segment) {
    const Cut at = result_.cuts[line];
    const std::array<double, 2> left{distance(at.from, at.to, segment[0]), distance(at.from, at.to, segment[1])};
    for (int side = 0; side < 2; ++side) {
      const std::array<double, 2> inside{side ? -left[0] : left[0], side ? -left[1] : left[1]};
      if (std::max(inside[0], inside[1]) <= thinnest_) continue;
      std::array<Vec2d, 2> part = segment;
      for (int end = 0; end < 2; ++end)
        if (inside[end] < 0) part[end] += (part[1 - end] - part[end]) * (inside[end] / (inside[end] - inside[1 - end]));
      if (at.sides[side] >= 0) {
        add(at.sides[side], part);
      } else {
        cut_part(~at.sides[side], part, &result_.cuts[line].sides[side]);
      }
    }
  }

  /// Divides a part along a segment, unless that would leave almost nothing on one side. `parent`: what names the part,
  /// if anything does.
  void cut_part(std::int32_t part, const std::array<Vec2d, 2>& segment, std::int32_t* parent) {
    const auto [a, b] = clipped(segment, result_.parts[part]);
    if ((b - a).length() <= thinnest_) return;
    double left = 0, right = 0;
    for (const Vec2d& corner : result_.parts[part]) {
      left = std::max(left, distance(a, b, corner));
      right = std::max(right, -distance(a, b, corner));
    }
    if (left <= thinnest_ || right <= thinnest_) return;
    divide(part, a, b, parent);
  }

  /// Divides a part between two of its corners.
  void halve(std::int32_t part) {
    const Polygon& polygon = result_.parts[part];
    for (Cut& line : result_.cuts)
      for (std::int32_t& side : line.sides)
        if (side == ~part) return divide(part, polygon[0], polygon[polygon.size() / 2], &side);
  }

  void divide(std::int32_t part, const Vec2d a, const Vec2d b, std::int32_t* parent) {
    std::array<Polygon, 2> halves = split(result_.parts[part], a, b);
    if (parent) *parent = std::int32_t(result_.cuts.size());
    result_.cuts.push_back({a, b, {~part, ~std::int32_t(result_.parts.size())}});
    result_.parts[part] = std::move(halves[0]);
    result_.parts.push_back(std::move(halves[1]));
  }

  const double thinnest_;
  CellParts result_;
};

}  // namespace

double position_rounding(const Primitive& primitive) {
  constexpr double kOfSize = 4e-7;
  double size = 0;
  for (const Vec3d& corner : primitive.corners) size = std::max(size, (corner - primitive.corners[0]).length());
  return kOfSize * size;
}

CellParts CellCutter::cut(const Polygon& cell) const {
  const double size = std::sqrt(area_of(cell));
  const Imath::Box2d box = box_of(cell);
  std::vector<std::array<Vec2d, 2>> segments;
  for (const Crossing& crossing : crossings_) {
    if (!counts(crossing, size)) continue;
    const std::array<Vec2d, 2> segment{crossing.from, crossing.to};
    if (box_of(segment).intersects(box)) segments.push_back(clipped(segment, cell));
  }
  const auto length = [](const std::array<Vec2d, 2>& s) { return (s[1] - s[0]).length(); };
  std::stable_sort(segments.begin(), segments.end(),
                   [&](const auto& a, const auto& b) { return length(a) > length(b); });
  Cutting cutting(cell, thinnest_part(size, rounding_));
  for (const auto& segment : segments) cutting.add(segment);
  return std::move(cutting).result();
}

bool CellCutter::is_closed(const Vec2d& a, const Vec2d& b) const {
  const Vec2d along = b - a;
  const double length = along.length();
  double covered = 0;
  for (const Crossing& crossing : crossings_) {
    if (!counts(crossing, length)) continue;
    const double thinnest = thinnest_part(length, rounding_);
    if (std::abs(distance(a, b, crossing.from)) > thinnest || std::abs(distance(a, b, crossing.to)) > thinnest)
      continue;
    double from = ((crossing.from - a) ^ along) / length, to = ((crossing.to - a) ^ along) / length;
    if (from > to) std::swap(from, to);
    covered += std::max(0.0, std::min(to, length) - std::max(from, 0.0));
  }
  return covered > 0.5 * length;
}

}  // namespace patchlight

#include "pipeline/model/cuts/region_shape.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {

namespace {

void extend(const Polygon& polygon, Vec2d& low, Vec2d& high) {
  low = high = polygon[0];
  for (const Vec2d& p : polygon)
    for (int k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
}

}  // namespace

RegionShape::RegionShape(const Primitive& primitive, const PlaneFrame& frame) {
  double high = low_ = 0;
  for (const auto& corners : primitive.region->pieces) {
    Piece& piece = pieces_.emplace_back();
    for (int k = 0; k < (corners[2] == corners[3] ? 3 : 4); ++k)
      piece.outline.push_back(frame.to_plane(position_at(primitive.corners, corners[k].x, corners[k].y)));
    extend(piece.outline, piece.low, piece.high);
    low_ = pieces_.size() == 1 ? piece.low.y : std::min(low_, piece.low.y);
    high = pieces_.size() == 1 ? piece.high.y : std::max(high, piece.high.y);
  }
  buckets_.resize(pieces_.size() / 4 + 1);
  size_ = std::max((high - low_) / double(buckets_.size()), 1e-300);
  for (std::size_t k = 0; k < pieces_.size(); ++k)
    for (int b = bucket(pieces_[k].low.y); b <= bucket(pieces_[k].high.y); ++b)
      buckets_[std::size_t(b)].push_back(std::int32_t(k));
}

int RegionShape::bucket(double y) const {
  return int(std::clamp((y - low_) / size_, 0.0, double(buckets_.size() - 1)));
}

std::vector<Polygon> RegionShape::inside(const Polygon& polygon) const {
  if (polygon.size() < 3) return {};
  Vec2d low, high;
  extend(polygon, low, high);
  std::vector<std::int32_t> near;
  const int lowest = bucket(low.y);
  for (int b = lowest; b <= bucket(high.y); ++b)
    for (const std::int32_t k : buckets_[std::size_t(b)]) {
      const Piece& piece = pieces_[std::size_t(k)];
      if (b != std::max(lowest, bucket(piece.low.y))) continue;  // found in an earlier bucket
      if (piece.low.x <= high.x && piece.high.x >= low.x && piece.low.y <= high.y && piece.high.y >= low.y)
        near.push_back(k);
    }
  std::sort(near.begin(), near.end());
  std::vector<Polygon> parts;
  for (const std::int32_t k : near) {
    Polygon part = intersection(pieces_[std::size_t(k)].outline, polygon);
    if (part.size() >= 3 && area_of(part) > 0) parts.push_back(std::move(part));
  }
  return parts;
}

bool RegionShape::holds(const Vec2d& point) const {
  const auto& near = buckets_[std::size_t(bucket(point.y))];
  return std::any_of(near.begin(), near.end(), [&](std::int32_t k) {
    const Polygon& outline = pieces_[std::size_t(k)].outline;
    for (std::size_t i = 0; i < outline.size(); ++i)
      if (side_of(outline[i], outline[(i + 1) % outline.size()], point) < 0) return false;
    return true;
  });
}

Region part_of(const Region& region, const Vec2d& low, const Vec2d& high) {
  const Polygon rectangle{low, {high.x, low.y}, high, {low.x, high.y}};
  const auto place = [&](const Vec2d& p) {
    const Vec2d at = (p - low) / (high - low);
    return Vec2d(std::clamp(at.x, 0.0, 1.0), std::clamp(at.y, 0.0, 1.0));
  };
  Region part;
  for (const auto& c : region.pieces) {
    const Polygon whole(c.begin(), c[2] == c[3] ? c.end() - 1 : c.end());
    const Polygon inside = intersection(whole, rectangle);
    for (std::size_t k = 2; k < inside.size(); k += 2) {  // quads about its first corner, the last maybe a triangle
      const std::array<Vec2d, 4> piece{place(inside[0]), place(inside[k - 1]), place(inside[k]),
                                       place(inside[std::min(k + 1, inside.size() - 1)])};
      if ((piece[2] - piece[0]).cross(piece[3] - piece[1]) > 0) part.pieces.push_back(piece);
    }
  }
  for (auto [from, to] : region.edges) {
    bool is_inside = true;
    for (int k = 0; k < 2 && is_inside; ++k)
      for (const auto& [limit, sign] : {std::pair(low[k], 1.0), {high[k], -1.0}}) {
        const double a = sign * (from[k] - limit), b = sign * (to[k] - limit);
        is_inside = is_inside && (a > 0 || b > 0 || (a == 0 && b == 0));
        if (is_inside && a < 0) from += (to - from) * (a / (a - b));
        if (is_inside && b < 0) to += (from - to) * (b / (b - a));
      }
    if (is_inside && place(from) != place(to)) part.edges.push_back({place(from), place(to)});
  }
  return part;
}

double area_of(const std::vector<Polygon>& polygons) {
  double area = 0;
  for (const Polygon& polygon : polygons) area += area_of(polygon);
  return area;
}

}  // namespace patchlight

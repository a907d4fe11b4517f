#include "pipeline/model/cuts/region_shape.h"

#include <algorithm>
#include <cmath>

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
  for (int b = bucket(low.y); b <= bucket(high.y); ++b)
    for (const std::int32_t k : buckets_[std::size_t(b)]) {
      const Piece& piece = pieces_[std::size_t(k)];
      if (piece.low.x <= high.x && piece.high.x >= low.x && piece.low.y <= high.y && piece.high.y >= low.y)
        near.push_back(k);
    }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  std::vector<Polygon> parts;
  for (const std::int32_t k : near) {
    Polygon part = intersection(pieces_[std::size_t(k)].outline, polygon);
    if (part.size() >= 3 && area_of(part) > 0) parts.push_back(std::move(part));
  }
  return parts;
}

double area_of(const std::vector<Polygon>& polygons) {
  double area = 0;
  for (const Polygon& polygon : polygons) area += area_of(polygon);
  return area;
}

}  // namespace patchlight

#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/model/cuts/plane_frame.h"
#include "pipeline/model/cuts/polygon.h"

namespace patchlight {

/// The region of a primitive in its PlaneFrame: finds the parts of cells that lie in it.
class RegionShape {
 public:
  /// `primitive`: one with a region.
  RegionShape(const Primitive& primitive, const PlaneFrame& frame);

  /// Convex polygons that tile the part of a convex polygon that is inside of the region.
  std::vector<Polygon> inside(const Polygon& polygon) const;

  bool holds(const Vec2d& point) const;

 private:
  struct Piece {
    Polygon outline;
    Vec2d low, high;  ///< Of its box, m.
  };

  int bucket(double x) const;

  std::vector<Piece> pieces_;
  double low_ = 0, size_ = 1;                       ///< Along y: the first bucket's start, and the height of each, m.
  std::vector<std::vector<std::int32_t>> buckets_;  ///< Pieces by what they overlap along y.
};

/// What of a region lies in a rectangle of (u,v), in the (u,v) of that rectangle. Its outline is where the region's is.
Region part_of(const Region& region, const Vec2d& low, const Vec2d& high);

double area_of(const std::vector<Polygon>& polygons);

}  // namespace patchlight

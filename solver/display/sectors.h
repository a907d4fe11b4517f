#pragma once
#include <array>
#include <span>
#include <vector>

#include "pipeline/optics/cuts/crossings.h"

namespace patchlight {

/// What lies around a point of a plane primitive: sectors that are parted by the surfaces which stand on it, and by its
/// outline.
struct Sectors {
  Vec2d at{0.0};             ///< The point.
  std::vector<double> rays;  ///< Angles of the surfaces that meet there, growing, rad; empty: none does.
  double height = 0;         ///< Largest height of their edges, m.

  bool parted() const { return !rays.empty(); }
  /// The sector in which a direction from the point lies.
  int of(const Vec2d& direction) const;
  /// The direction in the middle of a sector, of length 1.
  Vec2d middle(int sector) const;
};

/// Finds the sectors around points of a plane primitive.
class SectorFinder {
 public:
  /// `tolerance`: distance of a point from a crossing that passes through it, m.
  SectorFinder(const Primitive& primitive, const PlaneFrame& frame, double tolerance);

  /// `crossings`: those near the point, at least.
  Sectors around(const Vec2d& point, std::span<const Crossing> crossings) const;

 private:
  std::vector<std::array<Vec2d, 2>> outline_;
  double tolerance_;
};

}  // namespace patchlight

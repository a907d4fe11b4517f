#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/model/cuts/polygon.h"
#include "pipeline/optics/cuts/crossings.h"

namespace patchlight {

/// The convex parts of a cell that is cut along crossings.
struct CellParts {
  std::vector<Cut> cuts;       ///< A tree whose root is the first; sides are other cuts or ~part. Empty: not cut.
  std::vector<Polygon> parts;  ///< The cell itself if it is not cut.
};

/// Width below which parts of a cell of this size are left out, m. `rounding`: error of positions, m.
inline double thinnest_part(double size, double rounding) {
  return std::max(1e-5 * size, rounding);
}

/// Error of positions on a primitive by (u,v) in single precision, m.
double position_rounding(const Primitive& primitive);

/// Cuts the cells of a plane primitive along its crossings, so that no part lies on both sides of one.
class CellCutter {
 public:
  /// `small`: extent of crossings that are left out, over the size of a cell: light goes around them. `rounding`: error
  /// of positions on the primitive, m.
  CellCutter(std::span<const Crossing> crossings, double small, double rounding)
      : crossings_(crossings), small_(small), rounding_(rounding) {}

  static constexpr int kMostCorners = 8;
  static constexpr double kHighest = 0.25;  ///< Height of crossings that cut, over the size of a cell.

  /// Whether a crossing counts for cells of this size, m: it is not high above them, and not small.
  bool counts(const Crossing& crossing, double size) const {
    return crossing.height <= kHighest * size && crossing.extent >= small_ * size;
  }

  /// Cuts a convex cell into parts of at most kMostCorners corners. A line goes on beyond the crossing's ends to the
  /// next line or to the cell's edge.
  CellParts cut(const Polygon& cell) const;

  /// Whether crossings run along the edge from a to b for most of its length.
  bool is_closed(const Vec2d& a, const Vec2d& b) const;

 private:
  std::span<const Crossing> crossings_;
  double small_, rounding_;
};

}  // namespace patchlight

#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// What there is of a parallelogram: a planar surface with any outline and with holes, in the parallelogram's (u,v).
struct Region {
  /// Convex quads that tile it, counter-clockwise; a triangle repeats its last corner.
  std::vector<std::array<Vec2d, 4>> pieces;
  /// The edges of its outline; it lies to their left.
  std::vector<std::array<Vec2d, 2>> edges;

  static constexpr std::int64_t kMostCells = 1 << 26;  ///< Of the grids on all regions of a scene.

  bool operator==(const Region&) const = default;

  /// Its area over that of the parallelogram.
  double area() const;
  /// The region seen from behind: u runs the other way.
  Region mirrored() const;
};

}  // namespace patchlight

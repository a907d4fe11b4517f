#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/optics/surface/lattices.h"

namespace patchlight {

/// The cells over which irradiance is smoothed: those of a quad, or of quads that continue each other.
struct FilterGrid {
  std::int32_t first;  ///< Patch of the first cell; those of the others follow, unless there are `patches`.
  int nu, nv;
  std::vector<std::int32_t> patches{};  ///< [cells] -1: none.
  /// [cells] Whether the edge towards larger u, or v, is closed; empty: none is.
  std::vector<bool> ends_along_u{}, ends_along_v{};

  std::int32_t cells() const { return nu * nv; }
  std::int32_t patch(std::int32_t cell) const { return patches.empty() ? first + cell : patches[cell]; }
};

/// The grids with more than three cells along an edge.
std::vector<FilterGrid> filter_grids(const PatchSet& scene, const PatchLookup& lookup, const Lattices& lattices);

}  // namespace patchlight

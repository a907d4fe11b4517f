#include "solver/linear/filter_grids.h"

#include <algorithm>

namespace patchlight {

namespace {

constexpr std::int64_t kMostEmpty = 8;  // cells of a lattice's box over the patches on it

using Node = Lattices::Node;

bool is_large(const FilterGrid& grid) {
  return std::max(grid.nu, grid.nv) > 3;
}

/// Whether the rows of a primitive have equal numbers of cells: not those of most spheres.
bool has_equal_rows(const PatchLookup& lookup, std::int32_t primitive) {
  for (int k = 1; k < lookup.rows(primitive); ++k)
    if (lookup.row(primitive, k).cells != lookup.row(primitive, 0).cells) return false;
  return lookup.rows(primitive) > 0;
}

/// Sets the ends of a grid by its cells' closed edges, bits of Patch::closed. Shape: [cells].
void set_ends(const std::vector<std::uint8_t>& closed, FilterGrid& grid) {
  if (std::all_of(closed.begin(), closed.end(), [](std::uint8_t edges) { return edges == 0; })) return;
  for (std::int32_t i = 0; i < grid.cells(); ++i) {
    const bool last_u = i % grid.nu == grid.nu - 1, last_v = i / grid.nu == grid.nv - 1;
    grid.ends_along_u.push_back(closed[i] & 2 || (!last_u && closed[i + 1] & 8));
    grid.ends_along_v.push_back(closed[i] & 4 || (!last_v && closed[i + grid.nu] & 1));
  }
}

FilterGrid grid_of(const PatchLookup& lookup, std::int32_t primitive) {
  const PatchLookup::Row& first = lookup.row(primitive, 0);
  FilterGrid grid{first.in_region ? 0 : first.first, first.cells, lookup.rows(primitive)};
  std::vector<std::uint8_t> closed;
  for (int row = 0; row < grid.nv; ++row)
    for (int column = 0; column < grid.nu; ++column) {
      const std::int32_t patch = lookup.at(lookup.row(primitive, row), column);
      if (first.in_region) grid.patches.push_back(patch);
      closed.push_back(patch < 0 ? 15 : lookup.closed_edges(patch));
    }
  set_ends(closed, grid);
  return grid;
}

/// The grid of a lattice; without cells if most of its box is empty.
FilterGrid grid_of(const PatchLookup& lookup, const Lattices& lattices, const std::vector<std::int32_t>& quads) {
  Node low{INT64_MAX, INT64_MAX}, high{INT64_MIN, INT64_MIN};
  std::int64_t patches = 0;
  for (const std::int32_t i : quads) {
    const Lattices::Frame frame = lattices.frame(i);
    const int nu = lookup.row(i, 0).cells, nv = lookup.rows(i);
    patches += std::int64_t(nu) * nv;
    for (const Node& at : {frame.node(0, 0), frame.node(nu, nv)}) {
      low = {std::min(low.x, at.x), std::min(low.y, at.y)};
      high = {std::max(high.x, at.x), std::max(high.y, at.y)};
    }
  }
  const Node size = high - low;
  if (size.x > kMostEmpty * patches / size.y) return {0, 0, 0};
  FilterGrid grid{0, int(size.x), int(size.y), std::vector<std::int32_t>(std::size_t(size.x * size.y), -1)};
  std::vector<std::uint8_t> closed(grid.patches.size(), 15);
  for (const std::int32_t i : quads) {
    const Lattices::Frame frame = lattices.frame(i);
    for (int row = 0; row < lookup.rows(i); ++row)
      for (int column = 0; column < lookup.row(i, row).cells; ++column) {
        const Node at = frame.cell(column, row) - low;
        const std::int32_t patch = lookup.at(lookup.row(i, row), column);
        if (patch < 0) continue;
        grid.patches[at.y * size.x + at.x] = patch;
        closed[at.y * size.x + at.x] = frame.edges(lookup.closed_edges(patch));
      }
  }
  set_ends(closed, grid);
  return grid;
}

}  // namespace

std::vector<FilterGrid> filter_grids(const PatchSet& scene, const PatchLookup& lookup, const Lattices& lattices) {
  std::vector<FilterGrid> grids;
  std::vector<bool> is_joined(scene.primitives.size());
  for (const std::vector<std::int32_t>& quads : lattices.quads()) {
    FilterGrid grid = grid_of(lookup, lattices, quads);
    if (grid.cells() == 0) continue;
    for (const std::int32_t i : quads) is_joined[i] = true;
    if (is_large(grid)) grids.push_back(std::move(grid));
  }
  for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) {
    if (is_joined[i] || !has_equal_rows(lookup, i)) continue;
    FilterGrid grid = grid_of(lookup, i);
    if (is_large(grid)) grids.push_back(std::move(grid));
  }
  return grids;
}

}  // namespace patchlight

#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pipeline/optics/sampling/patch_lookup.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/smooth_edges.h"

namespace patchlight {

/// Where the grids of coplanar quads continue each other: at edges that they share, in whole or in part, with cells of
/// the same shape on both sides. Such quads lie on one lattice of cells, so that it does not matter how a surface is
/// split. Facets of curved meshes do not: they share smooth vertices.
class Lattices {
 public:
  Lattices(const PatchSet& scene, const PatchLookup& lookup) : Lattices(scene, lookup, SmoothEdges(scene.primitives)) {}
  Lattices(const PatchSet& scene, const PatchLookup& lookup, const SmoothEdges& smooth);

  /// A place on a lattice.
  struct Node {
    std::int64_t x = 0, y = 0;

    bool operator==(const Node&) const = default;
    Node operator+(const Node& b) const { return {x + b.x, y + b.y}; }
    Node operator-(const Node& b) const { return {x - b.x, y - b.y}; }
    Node operator*(std::int64_t factor) const { return {x * factor, y * factor}; }
  };

  /// Where a quad's grid lies on its lattice.
  struct Frame {
    std::int32_t lattice = -1;        ///< The first of its quads.
    Node origin{}, u{1, 0}, v{0, 1};  ///< Of corner (0,0) of the grid; steps to the next column and row.

    Node node(std::int64_t column, std::int64_t row) const { return origin + u * column + v * row; }
    /// The first node of a cell.
    Node cell(std::int64_t column, std::int64_t row) const;
    /// Edges of a cell of the grid, bits of Patch::closed, as edges of the cell of the lattice.
    std::uint8_t edges(std::uint8_t of_grid) const;
  };

  bool empty() const { return frames_.empty(); }
  /// The frame of quad `i`; without a lattice that it shares, its own grid.
  Frame frame(std::int32_t i) const;
  /// The quads of each lattice that has several.
  const std::vector<std::vector<std::int32_t>>& quads() const { return quads_; }

  /// The cell that continues quad `i` at (column, row), one cell beyond its border: its patch, or -1 where none does or
  /// anything stands on the edges between, or one of the cells is cut.
  std::int32_t beyond(std::int32_t i, int column, int row) const;

 private:
  class Builder;
  struct Cell {
    std::int32_t patch;
    std::uint8_t closed;  ///< As Patch::closed, with edges by growing x and y of the lattice.
  };
  struct Key {
    std::int32_t lattice;
    Node at;

    bool operator==(const Key&) const = default;
  };
  struct KeyHash {
    std::size_t operator()(const Key& k) const {
      return hash64(hash64(std::uint64_t(k.at.x) << 32 ^ std::uint64_t(k.at.y)) ^ std::uint64_t(k.lattice));
    }
  };

  const Cell* find(const Key& key) const;
  bool is_open(std::int32_t lattice, const Node& a, const Node& b) const;

  const PatchLookup& lookup_;
  std::unordered_map<std::int32_t, Frame> frames_;  ///< Of quads that share a lattice.
  std::vector<std::vector<std::int32_t>> quads_;
  std::unordered_map<Key, Cell, KeyHash> border_;  ///< Cells at the borders of grids, by their first nodes.
};

}  // namespace patchlight

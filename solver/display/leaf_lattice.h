#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "pipeline/model/display_mesh.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/lattices.h"

namespace patchlight {

constexpr int kMostLevels = 12;                 ///< Largest number of subdivisions of a patch.
constexpr int kFinestCells = 1 << kMostLevels;  ///< Along an edge of a patch.

/// Names a vertex of a DisplayMesh: faces share it if nothing stands between them there.
struct VertexKey {
  static constexpr std::int32_t kOfPoints = std::numeric_limits<std::int32_t>::min();

  /// First patch of the lattice or, on a sphere, of the ring; ~primitive where other surfaces stand; kOfPoints for
  /// SharedPoints, whose number is x.
  std::int32_t grid = 0;
  std::int64_t x = 0, y = 0;  ///< A node of the lattice of finest cells; a rounded position for a point on a cut.
  int sector = 0;             ///< Of Sectors, around the vertex.

  bool operator==(const VertexKey&) const = default;
};

struct VertexKeyHash {
  std::size_t operator()(const VertexKey& k) const {
    return hash64(std::uint64_t(k.x) << 32 ^ std::uint64_t(k.y)) ^
           hash64(std::uint64_t(k.grid) ^ std::uint64_t(k.sector) << 32);
  }
};

/// A leaf of a DisplayMesh on the grid of finest cells of a quad or ring.
struct Leaf {
  using Node = Lattices::Node;

  std::int32_t cell, patch;  ///< The patch is that of the root's cell in the grid.
  std::int32_t grid;         ///< First patch of the quad or ring.
  std::int32_t lattice;      ///< See VertexKey::grid.
  Lattices::Frame frame;     ///< Of the grid's nodes of finest cells.
  Node at;                   ///< Its first corner.
  int size;                  ///< In finest cells.
  Vec2f step;                ///< Size of a finest cell in (u,v).

  /// Corners are in rows of growing u.
  Node corner(int k) const { return at + Node{k % 2, k / 2} * size; }
  Vec2f uv(const Node& node) const {
    return {std::min(float(node.x) * step.x, 1.0f), std::min(float(node.y) * step.y, 1.0f)};
  }
  /// The key of a vertex that other quads of the lattice share, or one of this quad's own.
  VertexKey key(const Node& node, bool is_shared) const {
    const Node at_node = is_shared ? frame.node(node.x, node.y) : node;
    return {is_shared ? lattice : grid, at_node.x, at_node.y};
  }
};

/// The leaves of all patches of a mesh, in their order.
std::vector<Leaf> find_leaves(const PatchSet& scene, const PatchLookup& lookup, const Lattices& lattices,
                              const DisplayMesh& mesh);

}  // namespace patchlight

#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "pipeline/model/display_mesh.h"
#include "pipeline/optics/sampling/patch_lookup.h"
#include "pipeline/optics/sampling/random.h"

namespace patchlight {

constexpr int kMostLevels = 12;                 ///< Largest number of subdivisions of a patch.
constexpr int kFinestCells = 1 << kMostLevels;  ///< Along an edge of a patch.

/// Names a vertex of a DisplayMesh: faces share it if nothing stands between them there.
struct VertexKey {
  std::int32_t grid = 0;  ///< First patch of the plane or, on a sphere, of the ring; ~primitive for a point on a cut.
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

/// A leaf of a DisplayMesh on the lattice of finest cells.
struct Leaf {
  std::int32_t cell, patch;  ///< The patch is that of the root's cell in the grid.
  VertexKey at;              ///< Its first corner.
  int size;                  ///< In finest cells.
  Vec2f step;                ///< Size of a finest cell in (u,v).

  /// Corners are in rows of growing u.
  VertexKey corner(int k) const { return {at.grid, at.x + k % 2 * size, at.y + k / 2 * size}; }
  Vec2f uv(const VertexKey& node) const {
    return {std::min(float(node.x) * step.x, 1.0f), std::min(float(node.y) * step.y, 1.0f)};
  }
};

/// The leaves of all patches of a mesh, in their order.
std::vector<Leaf> find_leaves(const PatchSet& scene, const PatchLookup& lookup, const DisplayMesh& mesh);

}  // namespace patchlight

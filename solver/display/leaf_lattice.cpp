#include "solver/display/leaf_lattice.h"

namespace patchlight {

namespace {

void add_leaves(const Leaf& leaf, const DisplayMesh& mesh, std::vector<Leaf>& leaves) {
  const std::int32_t children = mesh.cells[leaf.cell].children;
  if (children < 0) {
    leaves.push_back(leaf);
    return;
  }
  Leaf quarter = leaf;
  quarter.size /= 2;
  for (int k = 0; k < 4; ++k) {
    quarter.cell = children + k;
    quarter.at = leaf.at + Leaf::Node{k % 2, k / 2} * quarter.size;
    add_leaves(quarter, mesh, leaves);
  }
}

}  // namespace

std::vector<Leaf> find_leaves(const PatchSet& scene, const PatchLookup& lookup, const Lattices& lattices,
                              const DisplayMesh& mesh) {
  std::vector<Leaf> leaves;
  std::vector<bool> visited(mesh.cells.size());
  for (std::size_t i = 0; i < mesh.roots.size(); ++i) {
    const std::int32_t root = mesh.roots[i];
    if (root < 0 || visited[root]) continue;
    visited[root] = true;
    const Patch& p = scene.patches[i];
    const int rows = lookup.rows(p.primitive), row = PatchLookup::cell(0.5f * (p.v0 + p.v1), rows);
    const PatchLookup::Row& cells = lookup.row(p.primitive, row);
    const int column = PatchLookup::cell(0.5f * (p.u0 + p.u1), cells.cells);
    const bool ring = scene.primitives[p.primitive].shape == Primitive::Shape::sphere;
    Lattices::Frame frame = lattices.frame(p.primitive);
    frame.origin = frame.origin * kFinestCells;
    const Vec2f step(1.0f / float(cells.cells * kFinestCells), 1.0f / float(rows * kFinestCells));
    const Leaf::Node at = Leaf::Node{column, row} * kFinestCells;
    const std::int32_t grid = lookup.nearest(ring ? cells : lookup.row(p.primitive, 0), 0);
    const std::int32_t lattice = ring ? grid : lookup.nearest(lookup.row(frame.lattice, 0), 0);
    add_leaves({root, lookup.at(cells, column), grid, lattice, frame, at, kFinestCells, step}, mesh, leaves);
  }
  return leaves;
}

}  // namespace patchlight

#include "pipeline/formats/solution/display_mesh_file.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

constexpr int kMaxDepth = 16;
const char* const kCells = "/display/mesh/cells";
const char* const kFacets = "/display/mesh/facets";
const char* const kVertices = "/display/mesh/vertices";

/// Checks that children follow their parent and that no cell has two parents, which excludes cycles. Sets the leaves.
void check_tree(const H5Reader& reader, DisplayMesh& mesh) {
  std::vector<int> depth(mesh.cells.size(), -1);
  for (const std::int32_t root : mesh.roots) {
    if (root < -1 || root >= std::int32_t(mesh.cells.size()) || (root >= 0 && depth[root] >= 0))
      reader.refuse("an index that is not of a root cell", "/display/mesh/roots");
    if (root >= 0) depth[root] = 0;
  }
  const auto cells = std::int64_t(mesh.cells.size());
  for (std::int64_t i = 0; i < cells; ++i) {
    DisplayMesh::Cell& cell = mesh.cells[i];
    if (depth[i] < 0 || depth[i] > kMaxDepth) reader.refuse("a cell without a parent, or too deep", kCells);
    if (cell.children < 0) {
      cell.leaf = mesh.elements;
      mesh.elements += cell.elements();
      continue;
    }
    if (cell.children <= i || cell.children + std::int64_t(4) > cells) reader.refuse("children out of bounds", kCells);
    for (int k = 0; k < 4; ++k) {
      if (depth[cell.children + k] >= 0) reader.refuse("a cell with two parents", kCells);
      depth[cell.children + k] = depth[i] + 1;
    }
  }
}

void check_facets(const H5Reader& reader, const DisplayMesh& mesh) {
  for (const auto& facet : mesh.facets) {
    if (facet.patch < 0 || facet.patch >= std::int64_t(mesh.roots.size()) || mesh.roots[facet.patch] >= 0)
      reader.refuse("a patch that is not a facet", kFacets);
    for (const std::int32_t corner : facet.corners)
      if (corner < -1 || corner >= mesh.gathered) reader.refuse("a corner out of bounds", kFacets);
  }
}

void check_vertices(const H5Reader& reader, const DisplayMesh& mesh, std::int64_t patches) {
  const auto count = std::int64_t(mesh.vertices.size()), midpoints = std::int64_t(mesh.midpoints.size());
  if (mesh.gathered < 0 || mesh.gathered + midpoints > count) reader.refuse("a number out of bounds", kVertices);
  for (const auto& v : mesh.vertices)
    if (v.patch < 0 || v.patch >= patches || !(v.u >= 0 && v.u <= 1 && v.v >= 0 && v.v <= 1))
      reader.refuse("a position out of bounds", kVertices);
  for (std::int64_t k = 0; k < midpoints; ++k)
    for (const std::int32_t end : mesh.midpoints[k])
      if (end < 0 || end >= count - midpoints + k) reader.refuse("a vertex out of order", "/display/mesh/midpoints");
  for (const auto& cell : mesh.cells)
    for (const std::int32_t corner : cell.corners)
      if (cell.children < 0 && (corner < 0 || corner >= count)) reader.refuse("a corner out of bounds", kCells);
}

}  // namespace

void write_display_mesh(H5Writer& writer, const DisplayMesh& mesh) {
  std::vector<std::int32_t> cells, facets, patches, midpoints;
  std::vector<float> positions;
  cells.reserve(6 * mesh.cells.size());
  patches.reserve(2 * mesh.vertices.size());
  positions.reserve(2 * mesh.vertices.size());
  for (const auto& cell : mesh.cells) {
    const auto& c = cell.corners;
    cells.insert(cells.end(), {cell.children, cell.cut, c[0], c[1], c[2], c[3]});
  }
  for (const auto& facet : mesh.facets) {
    facets.push_back(facet.patch);
    facets.insert(facets.end(), facet.corners.begin(), facet.corners.end());
  }
  for (const auto& vertex : mesh.vertices) {
    patches.insert(patches.end(), {vertex.patch, vertex.hidden});
    positions.insert(positions.end(), {vertex.u, vertex.v});
  }
  for (const auto& endpoints : mesh.midpoints) midpoints.insert(midpoints.end(), endpoints.begin(), endpoints.end());
  writer.dataset<std::int32_t>("/display/mesh/roots", mesh.roots);
  writer.dataset<std::int32_t>(kCells, cells, 6);
  writer.dataset<std::int32_t>(kFacets, facets, 5);
  writer.dataset<std::int32_t>("/display/mesh/vertex_patch", patches, 2);
  writer.dataset<float>(kVertices, positions, 2);
  writer.dataset<std::int32_t>("/display/mesh/midpoints", midpoints, 2);
  writer.attribute("display_vertices", std::int64_t(mesh.gathered));
}

DisplayMesh read_display_mesh(const H5Reader& reader, std::int64_t patches) {
  DisplayMesh mesh;
  mesh.roots = reader.dataset<std::int32_t>("/display/mesh/roots", patches);
  patches = std::int64_t(mesh.roots.size());
  const std::vector<std::int32_t> cells = reader.dataset<std::int32_t>(kCells, -1, 6);
  mesh.cells.reserve(cells.size() / 6);
  for (std::size_t k = 0; k < cells.size(); k += 6)
    mesh.cells.push_back({cells[k], -1, cells[k + 1] != 0, {cells[k + 2], cells[k + 3], cells[k + 4], cells[k + 5]}});
  const std::vector<std::int32_t> facets = reader.dataset<std::int32_t>(kFacets, -1, 5);
  for (std::size_t k = 0; k < facets.size(); k += 5)
    mesh.facets.push_back({facets[k], {facets[k + 1], facets[k + 2], facets[k + 3], facets[k + 4]}});
  const std::vector<float> positions = reader.dataset<float>(kVertices, -1, 2);
  const auto count = std::int64_t(positions.size() / 2);
  const std::vector<std::int32_t> owners = reader.dataset<std::int32_t>("/display/mesh/vertex_patch", count, 2);
  mesh.vertices.reserve(std::size_t(count));
  for (std::int64_t k = 0; k < count; ++k)
    mesh.vertices.push_back({owners[2 * k], positions[2 * k], positions[2 * k + 1], owners[2 * k + 1] != 0});
  const std::vector<std::int32_t> endpoints = reader.dataset<std::int32_t>("/display/mesh/midpoints", -1, 2);
  for (std::size_t k = 0; k < endpoints.size(); k += 2) mesh.midpoints.push_back({endpoints[k], endpoints[k + 1]});
  const std::int64_t gathered = reader.integer("display_vertices");
  if (gathered < 0 || gathered > count) reader.refuse("a number out of bounds", kVertices);
  mesh.gathered = std::int32_t(gathered);
  check_tree(reader, mesh);
  check_facets(reader, mesh);
  check_vertices(reader, mesh, patches);
  return mesh;
}

}  // namespace patchlight

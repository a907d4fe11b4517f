#include "pipeline/formats/solution/display_mesh_file.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

constexpr int kMaxDepth = 16;
constexpr int kMostMiddles = 4;
const char* const kCells = "/display/mesh/cells";
const char* const kCuts = "/display/mesh/cuts";
const char* const kFaces = "/display/mesh/faces";
const char* const kFacets = "/display/mesh/facets";
const char* const kVertices = "/display/mesh/vertices";
const char* const kFacetsOfVertices = "/display/mesh/vertex_facet";
const char* const kFacetsOfFacets = "/display/mesh/facet_facet";
const char* const kBlends = "/display/mesh/blends";
const char* const kBlendCounts = "/display/mesh/blend_counts";

/// Checks that children follow their parent and that no cell has two parents, which excludes cycles. The
/// parts of a cut cell share their root.
void check_tree(const H5Reader& reader, const DisplayMesh& mesh) {
  std::vector<int> depth(mesh.cells.size(), -1);
  for (const std::int32_t root : mesh.roots) {
    if (root < -1 || root >= std::int32_t(mesh.cells.size()))
      reader.refuse("an index that is not of a root cell", "/display/mesh/roots");
    if (root >= 0) depth[root] = 0;
  }
  const auto cells = std::int64_t(mesh.cells.size());
  for (std::int64_t i = 0; i < cells; ++i) {
    const DisplayMesh::Cell& cell = mesh.cells[i];
    if (depth[i] < 0 || depth[i] > kMaxDepth) reader.refuse("a cell without a parent, or too deep", kCells);
    if (cell.children < 0) continue;
    if (cell.children <= i || cell.children + std::int64_t(4) > cells) reader.refuse("children out of bounds", kCells);
    for (int k = 0; k < 4; ++k) {
      if (depth[cell.children + k] >= 0) reader.refuse("a cell with two parents", kCells);
      depth[cell.children + k] = depth[i] + 1;
    }
  }
}

/// Checks that every face belongs to one leaf, directly or by one tree of cuts, and has corners.
void check_faces(const H5Reader& reader, DisplayMesh& mesh) {
  std::vector<bool> faces(mesh.faces.size()), cuts(mesh.cuts.size());
  const auto visit = [&](std::vector<bool>& seen, std::int32_t i, const char* where) {
    if (i < 0 || std::size_t(i) >= seen.size() || seen[i]) reader.refuse("an index out of bounds, or twice", where);
    seen[i] = true;
  };
  std::vector<std::int32_t> todo;
  for (const DisplayMesh::Cell& cell : mesh.cells) {
    if (cell.children >= 0 || (cell.face == -1 && cell.cut < 0)) continue;  // outside of a region
    bool has_face = false;
    if (cell.cut < 0) {
      visit(faces, cell.face, kCells);
      has_face = true;
      if (mesh.faces[cell.face].count != 4) reader.refuse("a leaf without four corners", kFaces);
    } else {
      todo.push_back(cell.cut);
    }
    while (!todo.empty()) {
      const std::int32_t at = todo.back();
      todo.pop_back();
      if (at == Cut::kNothing) continue;
      if (at < 0) {
        visit(faces, ~at, kCuts);
        has_face = true;
        continue;
      }
      visit(cuts, at, kCuts);
      todo.insert(todo.end(), mesh.cuts[at].sides.begin(), mesh.cuts[at].sides.end());
    }
    if (!has_face) reader.refuse("cuts that leave nothing of a leaf", kCuts);
  }
  std::int64_t corners = 0;
  for (DisplayMesh::Face& face : mesh.faces) {
    if (face.patch < 0 || std::size_t(face.patch) >= mesh.roots.size() || face.count < 3 ||
        face.count > DisplayMesh::kMostCorners || face.middles < 0 || face.middles > kMostMiddles || !(face.part > 0))
      reader.refuse("a value out of range", kFaces);
    face.first = std::int32_t(corners);
    corners += face.count + face.middles;
  }
  if (corners != std::int64_t(mesh.corners.size()) || std::find(faces.begin(), faces.end(), false) != faces.end())
    reader.refuse("faces that do not fit the cells", kFaces);
  for (const Cut& cut : mesh.cuts)
    if (!(std::isfinite((cut.to - cut.from).length()) && (cut.to - cut.from).length() > 0))
      reader.refuse("a line that is not finite, or has no length", kCuts);
}

void check_facets(const H5Reader& reader, const DisplayMesh& mesh) {
  for (const auto& facet : mesh.facets) {
    if (facet.patch < 0 || facet.patch >= std::int64_t(mesh.roots.size()) || mesh.roots[facet.patch] >= 0 ||
        facet.facet < 0)
      reader.refuse("a patch that is not a facet", kFacets);
    const std::int64_t first_blend = std::int64_t(mesh.vertices.size());
    for (const std::int32_t corner : facet.corners)
      if (corner < -1 || corner >= first_blend + std::int64_t(mesh.blends.size()) ||
          (corner >= mesh.gathered && corner < first_blend))
        reader.refuse("a corner out of bounds", kFacets);
  }
  for (const auto& part : mesh.blended)
    if (part.vertex < 0 || part.vertex >= mesh.gathered || !(part.weight >= 0 && part.weight <= 1))
      reader.refuse("a value out of range", kBlends);
}

void check_vertices(const H5Reader& reader, const DisplayMesh& mesh, std::int64_t patches) {
  const auto count = std::int64_t(mesh.vertices.size()), midpoints = std::int64_t(mesh.midpoints.size());
  if (mesh.gathered < 0 || mesh.gathered + midpoints > count) reader.refuse("a number out of bounds", kVertices);
  for (const auto& v : mesh.vertices)
    if (v.patch < 0 || v.patch >= patches || v.facet < 0 || !(v.u >= 0 && v.u <= 1 && v.v >= 0 && v.v <= 1))
      reader.refuse("a position out of bounds", kVertices);
  for (std::int64_t k = 0; k < midpoints; ++k)
    for (const std::int32_t end : mesh.midpoints[k])
      if (end < 0 || end >= count - midpoints + k) reader.refuse("a vertex out of order", "/display/mesh/midpoints");
  for (const std::int32_t corner : mesh.corners)
    if (corner < 0 || corner >= count) reader.refuse("a corner out of bounds", "/display/mesh/corners");
}

/// Makes an entry of each row of a dataset.
template <class T, class Entries, class Fill>
void read_all(const H5Reader& reader, const std::string& name, Entries& entries, int columns, Fill fill) {
  entries.resize(std::size_t(reader.rows(name, columns)));
  reader.read_into<T>(name, entries, columns, fill);
}

/// Datasets that a mesh without clusters of facets lacks.
void write_blends(H5Writer& writer, const DisplayMesh& mesh) {
  const auto is_of_cluster = [](const auto& place) { return place.facet > 0; };
  if (mesh.blends.empty() && std::none_of(mesh.facets.begin(), mesh.facets.end(), is_of_cluster)) return;
  std::vector<std::int32_t> of_vertices, of_facets, counts, blended;
  std::vector<float> weights;
  for (const auto& vertex : mesh.vertices) of_vertices.push_back(vertex.facet);
  for (const auto& facet : mesh.facets) of_facets.push_back(facet.facet);
  for (const auto& blend : mesh.blends) counts.push_back(blend.count);
  for (const auto& part : mesh.blended) {
    blended.push_back(part.vertex);
    weights.push_back(part.weight);
  }
  writer.dataset<std::int32_t>(kFacetsOfVertices, of_vertices);
  writer.dataset<std::int32_t>(kFacetsOfFacets, of_facets);
  writer.dataset<std::int32_t>(kBlendCounts, counts);
  writer.dataset<std::int32_t>(kBlends, blended);
  writer.dataset<float>("/display/mesh/blend_weights", weights);
}

void read_blends(const H5Reader& reader, DisplayMesh& mesh) {
  if (!reader.has(kFacetsOfVertices)) return;
  reader.read_into<std::int32_t>(kFacetsOfVertices, mesh.vertices, 0, [](auto& v, auto* r) { v.facet = *r; });
  reader.read_into<std::int32_t>(kFacetsOfFacets, mesh.facets, 0, [](auto& facet, auto* r) { facet.facet = *r; });
  read_all<std::int32_t>(reader, kBlends, mesh.blended, 0, [](auto& part, auto* r) { part.vertex = *r; });
  reader.read_into<float>("/display/mesh/blend_weights", mesh.blended, 0, [](auto& p, auto* r) { p.weight = *r; });
  read_all<std::int32_t>(reader, kBlendCounts, mesh.blends, 0, [](auto& blend, auto* r) { blend.count = *r; });
  std::int64_t first = 0;
  for (DisplayMesh::Blend& blend : mesh.blends) {
    blend.first = std::int32_t(first);
    if (blend.count < 1 || first + blend.count > std::int64_t(mesh.blended.size()))
      reader.refuse("a number out of bounds", kBlendCounts);
    first += blend.count;
  }
  if (first != std::int64_t(mesh.blended.size())) reader.refuse("parts of no blend", kBlendCounts);
}

}  // namespace

void write_display_mesh(H5Writer& writer, const DisplayMesh& mesh) {
  std::vector<std::int32_t> cells, sides, faces, facets, patches, midpoints;
  std::vector<double> lines;
  std::vector<float> parts, positions;
  cells.reserve(3 * mesh.cells.size());
  patches.reserve(mesh.vertices.size());
  positions.reserve(2 * mesh.vertices.size());
  for (const auto& cell : mesh.cells) cells.insert(cells.end(), {cell.children, cell.face, cell.cut});
  for (const auto& cut : mesh.cuts) {
    lines.insert(lines.end(), {cut.from.x, cut.from.y, cut.to.x, cut.to.y});
    sides.insert(sides.end(), cut.sides.begin(), cut.sides.end());
  }
  for (const auto& face : mesh.faces) {
    faces.insert(faces.end(), {face.patch, face.count, face.middles});
    parts.push_back(face.part);
  }
  for (const auto& facet : mesh.facets) {
    facets.push_back(facet.patch);
    facets.insert(facets.end(), facet.corners.begin(), facet.corners.end());
  }
  for (const auto& vertex : mesh.vertices) {
    patches.push_back(vertex.patch);
    positions.insert(positions.end(), {vertex.u, vertex.v});
  }
  for (const auto& endpoints : mesh.midpoints) midpoints.insert(midpoints.end(), endpoints.begin(), endpoints.end());
  writer.dataset<std::int32_t>("/display/mesh/roots", mesh.roots);
  writer.dataset<std::int32_t>(kCells, cells, 3);
  writer.dataset<double>(kCuts, lines, 4);
  writer.dataset<std::int32_t>("/display/mesh/cut_sides", sides, 2);
  writer.dataset<std::int32_t>(kFaces, faces, 3);
  writer.dataset<float>("/display/mesh/face_part", parts);
  writer.dataset<std::int32_t>("/display/mesh/corners", mesh.corners);
  writer.dataset<std::int32_t>(kFacets, facets, 5);
  writer.dataset<std::int32_t>("/display/mesh/vertex_patch", patches);
  writer.dataset<float>(kVertices, positions, 2);
  writer.dataset<std::int32_t>("/display/mesh/midpoints", midpoints, 2);
  write_blends(writer, mesh);
  writer.attribute("display_vertices", std::int64_t(mesh.gathered));
}

DisplayMesh read_display_mesh(const H5Reader& reader, std::int64_t patches) {
  DisplayMesh mesh;
  mesh.roots = reader.dataset<std::int32_t>("/display/mesh/roots", patches);
  patches = std::int64_t(mesh.roots.size());
  read_all<std::int32_t>(reader, kCells, mesh.cells, 3, [](auto& cell, auto* r) { cell = {r[0], r[1], r[2]}; });
  read_all<double>(reader, kCuts, mesh.cuts, 4, [](Cut& cut, auto* r) {
    cut.from = {r[0], r[1]};
    cut.to = {r[2], r[3]};
  });
  reader.read_into<std::int32_t>("/display/mesh/cut_sides", mesh.cuts, 2, [](Cut& cut, auto* r) {
    cut.sides = {r[0], r[1]};
  });
  read_all<std::int32_t>(reader, kFaces, mesh.faces, 3, [](auto& face, auto* r) {
    face = {r[0], 0, r[1], 1.0f, r[2]};
  });
  reader.read_into<float>("/display/mesh/face_part", mesh.faces, 0, [](auto& face, auto* r) { face.part = *r; });
  mesh.corners = reader.dataset<std::int32_t>("/display/mesh/corners", -1);
  read_all<std::int32_t>(reader, kFacets, mesh.facets, 5, [](auto& facet, auto* r) {
    facet = {r[0], {r[1], r[2], r[3], r[4]}};
  });
  read_all<float>(reader, kVertices, mesh.vertices, 2, [](auto& vertex, auto* r) { vertex = {0, r[0], r[1]}; });
  reader.read_into<std::int32_t>("/display/mesh/vertex_patch", mesh.vertices, 0,
                                 [](auto& vertex, auto* r) { vertex.patch = *r; });
  read_all<std::int32_t>(reader, "/display/mesh/midpoints", mesh.midpoints, 2, [](auto& ends, auto* r) {
    ends = {r[0], r[1]};
  });
  const auto count = std::int64_t(mesh.vertices.size());
  read_blends(reader, mesh);
  const std::int64_t gathered = reader.integer("display_vertices");
  if (gathered < 0 || gathered > count) reader.refuse("a number out of bounds", kVertices);
  mesh.gathered = std::int32_t(gathered);
  check_tree(reader, mesh);
  check_faces(reader, mesh);
  check_facets(reader, mesh);
  check_vertices(reader, mesh, patches);
  return mesh;
}

}  // namespace patchlight

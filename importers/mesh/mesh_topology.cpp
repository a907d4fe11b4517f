#include "importers/mesh/mesh_topology.h"

#include <OpenMesh/Core/Mesh/TriConnectivity.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>
#include <cmath>

#include "importers/mesh/open_edges.h"
#include "importers/mesh/t_vertices.h"
#include "importers/mesh/vertex_welding.h"

namespace patchlight {
namespace {

constexpr double kMinHeight = 1e-7;           // of a triangle, relative to its longest edge
constexpr double kMinSquaredLength = 1e-200;  // of the longest edge, m2; below, areas of patches underflow
constexpr double kCoplanarSine = 1e-3;        // of the dihedral angle at an edge
constexpr double kCreaseCosine = 0.5;         // 60 degrees
constexpr float kSameNormalCosine = 0.9998f;
constexpr float kFlatCosine = 0.9995f;  // between normals quantized to 8 bits
constexpr double kMaxFoldSine = 0.1;
constexpr int kMaxLayers = 8;         // attempts with duplicated vertices, before a triangle gets its own
constexpr int kMaxVertexUses = 1024;  // triangles at a vertex; OpenMesh visits all of them for each one added

/// Twice the vector area.
Vec3d area_vector(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return (b - a).cross(c - a);
}

bool has_area(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double longest = std::max({(b - a).length2(), (c - b).length2(), (a - c).length2()});
  return area_vector(a, b, c).length() > kMinHeight * longest && longest > kMinSquaredLength;
}

/// OpenMesh's half-edge connectivity and the positions of its vertices.
struct Connectivity {
  OpenMesh::TriConnectivity mesh;
  std::vector<std::int32_t> soup_triangle;  ///< By face.
  std::vector<Vec3d> positions;             ///< By vertex.
};

/// Vertices of one attempt to connect triangles: the current copy of each welded vertex and its number of triangles.
struct VertexLayer {
  explicit VertexLayer(std::size_t count) : vertex(count), uses(count, 0) {}

  std::vector<OpenMesh::VertexHandle> vertex;
  std::vector<int> uses;

  OpenMesh::VertexHandle vertex_for(Connectivity& connected, std::int32_t weld, const Vec3d& position) {
    if (!vertex[weld].is_valid() || uses[weld] == kMaxVertexUses) {
      vertex[weld] = connected.mesh.add_vertex();
      uses[weld] = 0;
      connected.positions.push_back(position);
    }
    ++uses[weld];
    return vertex[weld];
  }
};

Connectivity connect(const std::vector<Vec3d>& positions, const std::vector<std::int32_t>& weld,
                     std::vector<std::int32_t> triangles) {
  Connectivity connected;
  omerr().disable();  // it reports each triangle that cannot be added
  for (int layer = 0; !triangles.empty(); ++layer) {
    const bool separate = layer >= kMaxLayers;
    VertexLayer vertices(positions.size());
    std::vector<std::int32_t> refused;
    for (const std::int32_t triangle : triangles) {
      std::array<OpenMesh::VertexHandle, 3> corners;
      for (int i = 0; i < 3; ++i) {
        const std::int32_t corner = 3 * triangle + i;
        corners[i] = vertices.vertex_for(connected, separate ? corner : weld[corner], positions[corner]);
      }
      if (connected.mesh.add_face(corners[0], corners[1], corners[2]).is_valid()) {
        connected.soup_triangle.push_back(triangle);
      } else {
        refused.push_back(triangle);
      }
    }
    triangles = std::move(refused);
  }
  return connected;
}

void fill_triangles(const Connectivity& connected, MeshTopology& topology) {
  for (const auto& face : connected.mesh.faces()) {
    MeshTopology::Triangle& triangle = topology.triangles.emplace_back();
    OpenMesh::HalfedgeHandle edge = connected.mesh.halfedge_handle(face);
    for (int i = 0; i < 3; ++i, edge = connected.mesh.next_halfedge_handle(edge)) {
      triangle.vertices[i] = connected.mesh.from_vertex_handle(edge).idx();
      triangle.neighbors[i] = connected.mesh.opposite_face_handle(edge).idx();
    }
    const std::array<std::int32_t, 3>& v = triangle.vertices;
    const Vec3d vector_area2 = area_vector(topology.vertices[v[0]], topology.vertices[v[1]], topology.vertices[v[2]]);
    triangle.area = vector_area2.length() * 0.5;
    triangle.normal = vector_area2.normalized();
  }
}

int corner_index(const MeshTopology::Triangle& triangle, std::int32_t vertex) {
  return static_cast<int>(std::find(triangle.vertices.begin(), triangle.vertices.end(), vertex) -
                          triangle.vertices.begin());
}

/// The soup's values by corner, in the order of the connected triangles' corners.
template <class Value>
std::vector<Value> reordered_by_corner(const std::vector<Value>& values, const std::vector<Vec3d>& positions,
                                       const Connectivity& connected, const MeshTopology& topology) {
  std::vector<Value> result(topology.triangles.size() * 3);
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t corner = 3 * static_cast<std::size_t>(connected.soup_triangle[t]) + i;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d& position = topology.vertices[topology.triangles[t].vertices[k]];
        if (position == positions[corner]) result[3 * t + k] = values[corner];
      }
    }
  }
  return result;
}

/// Omits all normals of triangles that lack one, or of which one points behind the triangle: these are shaded flat.
void omit_normals_behind(MeshTopology& topology) {
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    const auto corners = topology.normals.begin() + static_cast<std::ptrdiff_t>(3 * t);
    const Vec3f normal(topology.triangles[t].normal);
    const auto is_behind = [&](const Vec3f& n) { return n != Vec3f(0.0f) && n.dot(normal) <= 0.0f; };
    topology.normals_behind += static_cast<std::size_t>(std::count_if(corners, corners + 3, is_behind));
    if (std::any_of(corners, corners + 3, [&](const Vec3f& n) { return n.dot(normal) <= 0.0f; }))
      std::fill(corners, corners + 3, Vec3f(0.0f));
  }
}

void number_smooth_vertices(MeshTopology& topology) {
  const std::vector<Vec3f>& normals = topology.normals;
  DisjointSets sets(topology.triangles.size() * 3);
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    const MeshTopology::Triangle& a = topology.triangles[t];
    for (int i = 0; i < 3; ++i) {
      const std::int32_t other = a.neighbors[i];
      if (other <= static_cast<std::int32_t>(t)) continue;  // no neighbour, or visited before
      const MeshTopology::Triangle& b = topology.triangles[other];
      const std::array<int, 2> corners{static_cast<int>(3 * t) + i, static_cast<int>(3 * t) + (i + 1) % 3};
      const std::array<int, 2> others{3 * other + corner_index(b, a.vertices[i]),
                                      3 * other + corner_index(b, a.vertices[(i + 1) % 3])};
      const double cosine = a.normal.dot(b.normal);
      const bool coplanar = cosine > 0.0 && a.normal.cross(b.normal).length() < kCoplanarSine;
      const auto agree = [&](int k) { return normals[corners[k]].dot(normals[others[k]]) > kSameNormalCosine; };
      if (!coplanar && !(cosine > kCreaseCosine && agree(0) && agree(1))) continue;
      for (int k = 0; k < 2; ++k) sets.join(corners[k], others[k]);
    }
  }
  std::vector<std::int32_t> number(sets.parent.size(), -1);
  std::int32_t count = 0;
  for (std::size_t corner = 0; corner < sets.parent.size(); ++corner) {
    std::int32_t& id = number[sets.find(static_cast<std::int32_t>(corner))];
    if (id < 0) id = count++;
    topology.triangles[corner / 3].smooth_vertices[corner % 3] = id;
  }
}

void find_components(MeshTopology& topology) {
  std::vector<char> visited(topology.triangles.size(), 0);
  for (std::size_t seed = 0; seed < topology.triangles.size(); ++seed) {
    if (visited[seed]) continue;
    MeshTopology::Component& component = topology.components.emplace_back();
    component.closed = true;
    component.triangles.push_back(static_cast<std::int32_t>(seed));
    visited[seed] = 1;
    for (std::size_t i = 0; i < component.triangles.size(); ++i) {
      for (const std::int32_t neighbor : topology.triangles[component.triangles[i]].neighbors) {
        component.closed = component.closed && neighbor >= 0;
        if (neighbor < 0 || visited[neighbor]) continue;
        visited[neighbor] = 1;
        component.triangles.push_back(neighbor);
      }
    }
    std::sort(component.triangles.begin(), component.triangles.end());
  }
}

}  // namespace

bool flat_by_normals(const MeshTopology& topology, std::int32_t a, std::int32_t b) {
  if (!topology.quantized) return true;
  const Vec3f first = topology.normals[3 * static_cast<std::size_t>(a)];
  if (first == Vec3f(0.0f))
    return topology.triangles[a].normal.cross(topology.triangles[b].normal).length() <= kMaxFoldSine;
  for (const std::int32_t triangle : {a, b}) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (!(first.dot(topology.normals[3 * static_cast<std::size_t>(triangle) + i]) >= kFlatCosine)) return false;
    }
  }
  return true;
}

MeshTopology build_topology(const TriangleSoup& of_file) {
  std::vector<Vec3d> positions = with_closed_seams(of_file);
  std::optional<TriangleSoup> split = split_at_t_vertices(of_file, positions);
  if (split) positions = split->positions;
  const TriangleSoup& soup = split ? *split : of_file;
  MeshTopology topology;
  topology.added_triangles = (soup.positions.size() - of_file.positions.size()) / 3;
  topology.rounding = soup.rounding;
  topology.texcoord_rounding = soup.texcoord_rounding;
  topology.quantized = soup.quantized;
  std::vector<std::int32_t> triangles;
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
    if (has_area(positions[i], positions[i + 1], positions[i + 2])) {
      triangles.push_back(static_cast<std::int32_t>(i / 3));
    } else {
      ++topology.degenerate_triangles;
    }
  }
  const std::vector<std::int32_t> vertices = split_non_manifold_vertices(weld_corners(positions), triangles);
  Connectivity connected = connect(positions, vertices, std::move(triangles));
  topology.vertices = std::move(connected.positions);
  fill_triangles(connected, topology);
  topology.normals = reordered_by_corner(soup.normals, positions, connected, topology);
  omit_normals_behind(topology);
  number_smooth_vertices(topology);
  for (const auto& texcoords : soup.texcoords)
    topology.texcoords.push_back(reordered_by_corner(texcoords, positions, connected, topology));
  if (!soup.colors.empty()) topology.colors = reordered_by_corner(soup.colors, positions, connected, topology);
  find_components(topology);
  return topology;
}

}  // namespace patchlight

#include "solver/display/display_vertices.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/transport/elements.h"
#include "solver/form_factors/harmonic_distance.h"

namespace patchlight {

namespace {

constexpr int kSteps = 1 << kDisplayLevels;  // finest cells along a patch
constexpr float kMinVisibility = 0.75f;      // visibility, relative to the most visible corner of a leaf, below which a
                                             // corner is hidden; higher than at the edge of a panel near a wall
constexpr float kNudge = 0.02f;  // of a finest cell: distance of vertices from edges, where surfaces may meet

/// A node of the lattice of a primitive's finest cells; on a sphere, of a ring's.
struct Node {
  std::int32_t row_first = 0;  ///< First patch of the ring, or of the plane.
  std::int32_t x = 0, y = 0;

  bool operator==(const Node&) const = default;
};

struct NodeHash {
  std::size_t operator()(const Node& n) const {
    return hash64(std::uint64_t(std::uint32_t(n.x)) << 32 | std::uint32_t(n.y)) ^ hash64(std::uint64_t(n.row_first));
  }
};

enum class Kind { gathered, border, midpoint };

struct Leaf {
  std::int32_t cell, patch;
  Node at;  ///< Its first corner.
  int size;
};

std::uint64_t edge_key(const Primitive& p, int edge) {
  constexpr std::array<std::array<int, 2>, 4> kEnds{{{0, 1}, {1, 2}, {3, 2}, {0, 3}}};
  const std::int32_t a = p.smooth_vertices[kEnds[edge][0]], b = p.smooth_vertices[kEnds[edge][1]];
  if (a < 0 || b < 0 || a == b) return 0;
  return std::uint64_t(std::uint32_t(std::min(a, b))) << 32 | std::uint32_t(std::max(a, b));
}

class Vertices {
 public:
  Vertices(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup, const SmoothEdges& smooth,
           DisplayMesh& mesh)
      : scene_(scene), ray_scene_(ray_scene), lookup_(lookup), smooth_(smooth), mesh_(mesh) {}

  void add() {
    for (std::size_t i = 0; i < mesh_.roots.size(); ++i)
      if (mesh_.roots[i] >= 0) add_leaves(std::int32_t(i));
    for (const Leaf& leaf : leaves_)
      for (int k = 0; k < 4; ++k) mesh_.cells[leaf.cell].corners[k] = vertex(leaf, corner(leaf, k));
    hide_covered();
    cut_crossed();
    std::stable_sort(leaves_.begin(), leaves_.end(), [](const Leaf& a, const Leaf& b) { return a.size > b.size; });
    for (const Leaf& leaf : leaves_)
      for (const auto& [a, b] : {std::pair(0, 1), {1, 3}, {2, 3}, {0, 2}})
        if (!mesh_.cells[leaf.cell].cut) find_midpoints(corner(leaf, a), corner(leaf, b));
    renumber();
  }

 private:
  static Node corner(const Leaf& leaf, int k) {
    return {leaf.at.row_first, leaf.at.x + k % 2 * leaf.size, leaf.at.y + k / 2 * leaf.size};
  }

  void add_leaves(std::int32_t patch) {
    const Patch& p = scene_.patches[patch];
    const int rows = lookup_.rows(p.primitive), row = PatchLookup::cell(0.5f * (p.v0 + p.v1), rows);
    const PatchLookup::Row& cells = lookup_.row(p.primitive, row);
    const bool ring = scene_.primitives[p.primitive].shape == Primitive::Shape::sphere;
    const Node at{ring ? cells.first : lookup_.row(p.primitive, 0).first, (patch - cells.first) * kSteps, row * kSteps};
    add_leaves({mesh_.roots[patch], patch, at, kSteps});
  }

  void add_leaves(const Leaf& leaf) {
    const std::int32_t children = mesh_.cells[leaf.cell].children;
    if (children < 0) {
      leaves_.push_back(leaf);
      return;
    }
    const int half = leaf.size / 2;
    for (int k = 0; k < 4; ++k)
      add_leaves(
          {children + k, leaf.patch, {leaf.at.row_first, leaf.at.x + k % 2 * half, leaf.at.y + k / 2 * half}, half});
  }

  std::int32_t vertex(const Leaf& leaf, const Node& node) {
    const auto [at, is_new] = numbers_.try_emplace(node, std::int32_t(mesh_.vertices.size()));
    if (!is_new) return at->second;
    const Patch& patch = scene_.patches[leaf.patch];
    const int rows = lookup_.rows(patch.primitive);
    const int row = PatchLookup::cell(0.5f * (patch.v0 + patch.v1), rows);
    const float u_step = 1.0f / float(lookup_.row(patch.primitive, row).cells * kSteps);
    const float v_step = 1.0f / float(rows * kSteps);
    const float u = std::min(float(node.x) * u_step, 1.0f), v = std::min(float(node.y) * v_step, 1.0f);
    const bool border = is_border(patch.primitive, u, v, 0.5f * u_step, 0.5f * v_step);
    kinds_.push_back(border ? Kind::border : Kind::gathered);
    const auto nudged = [](float x, float step, std::uint64_t random) {
      const float shift = kNudge * step * (random & 1 ? 1.0f : -1.0f);
      return x + shift < 0.0f || x + shift > 1.0f ? x - shift : x + shift;
    };
    const std::uint64_t random = NodeHash()(node);
    mesh_.vertices.push_back(
        border ? DisplayMesh::Vertex{leaf.patch, u, v}
               : DisplayMesh::Vertex{leaf.patch, nudged(u, u_step, random), nudged(v, v_step, random >> 1)});
    return at->second;
  }

  void hide_covered() {
    std::vector<float> visible(mesh_.vertices.size(), 1.0f);
    tbb::parallel_for(std::size_t(0), visible.size(), [&](std::size_t k) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
      if (kinds_[k] == Kind::border) return;
      const DisplayMesh::Vertex& vertex = mesh_.vertices[k];
      const std::int32_t primitive = scene_.patches[vertex.patch].primitive;
      const SurfacePoint point = point_at(scene_.primitives[primitive], vertex.u, vertex.v);
      visible[k] = lit_ray_fraction(scene_, ray_scene_, primitive, point, hash64(k));
    });
    for (const Leaf& leaf : leaves_) {
      DisplayMesh::Cell& cell = mesh_.cells[leaf.cell];
      float largest = 0;
      for (const std::int32_t k : cell.corners) largest = std::max(largest, visible[k]);
      for (const std::int32_t k : cell.corners) {
        if (visible[k] >= kMinVisibility * largest) continue;
        mesh_.vertices[k].hidden = true;
        cell.cut = true;
      }
    }
  }

  /// Marks leaves as cut whose corners do not all see each other.
  void cut_crossed() {
    tbb::parallel_for(std::size_t(0), leaves_.size(), [&](std::size_t k) {
      _mm_setcsr(_mm_getcsr() | 0x8040);
      DisplayMesh::Cell& cell = mesh_.cells[leaves_[k].cell];
      cell.cut = cell.cut || is_crossed(cell, scene_.patches[leaves_[k].patch].primitive);
    });
  }

  /// Whether something that stands on a leaf or goes through it parts its corners.
  bool is_crossed(const DisplayMesh::Cell& cell, std::int32_t primitive) const {
    if (scene_.primitives[primitive].shape == Primitive::Shape::sphere) return false;
    std::array<Vec2f, 4> corners;
    for (int k = 0; k < 4; ++k) corners[k] = {mesh_.vertices[cell.corners[k]].u, mesh_.vertices[cell.corners[k]].v};
    return visible_corners(scene_, ray_scene_, mesh_, cell, primitive, corners) != 0xffff;
  }

  /// Whether a point lies on an undivided patch, or on an edge shared smoothly with a neighbour.
  bool is_border(std::int32_t i, float u, float v, float u_step, float v_step) const {
    const Primitive& primitive = scene_.primitives[i];
    const bool sphere = primitive.shape == Primitive::Shape::sphere;
    for (const float y : {v - v_step, v + v_step})
      for (float x : {u - u_step, u + u_step}) {
        if (sphere) x -= std::floor(x);
        const int edge = y < 0 ? 0 : x > 1 ? 1 : y > 1 ? 2 : x < 0 ? 3 : -1;
        if (edge < 0 ? mesh_.roots[lookup_.patch(i, x, y)] < 0 : !sphere && smooth_.is_smooth(primitive, edge))
          return true;
      }
    return false;
  }

  /// Finds vertices of smaller leaves on the edge of a leaf whose corners see each other.
  void find_midpoints(const Node& a, const Node& b) {
    if (std::abs(b.x - a.x) + std::abs(b.y - a.y) < 2) return;
    const Node middle{a.row_first, (a.x + b.x) / 2, (a.y + b.y) / 2};
    const auto found = numbers_.find(middle);
    if (found == numbers_.end()) return;
    const std::int32_t k = found->second, from = numbers_.at(a), to = numbers_.at(b);
    if (kinds_[k] == Kind::gathered) {
      kinds_[k] = Kind::midpoint;
      midpoints_.push_back({k, from, to});
    }
    find_midpoints(a, middle);
    find_midpoints(middle, b);
  }

  void renumber() {
    std::vector<std::int32_t> order, number(kinds_.size());
    for (const Kind kind : {Kind::gathered, Kind::border}) {
      for (std::int32_t i = 0; i < std::int32_t(kinds_.size()); ++i)
        if (kinds_[i] == kind) order.push_back(i);
      if (kind == Kind::gathered) mesh_.gathered = std::int32_t(order.size());
    }
    for (const auto& m : midpoints_) order.push_back(m[0]);
    std::vector<DisplayMesh::Vertex> vertices;
    for (std::size_t k = 0; k < order.size(); ++k) {
      number[order[k]] = std::int32_t(k);
      vertices.push_back(mesh_.vertices[order[k]]);
    }
    mesh_.vertices = std::move(vertices);
    for (const auto& m : midpoints_) mesh_.midpoints.push_back({number[m[1]], number[m[2]]});
    for (const Leaf& leaf : leaves_)
      for (std::int32_t& k : mesh_.cells[leaf.cell].corners) k = number[k];
  }

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const PatchLookup& lookup_;
  const SmoothEdges& smooth_;
  DisplayMesh& mesh_;
  std::vector<Leaf> leaves_;
  std::unordered_map<Node, std::int32_t, NodeHash> numbers_;
  std::vector<Kind> kinds_;                             ///< [vertices].
  std::vector<std::array<std::int32_t, 3>> midpoints_;  ///< A vertex and the two vertices it lies between.
};

}  // namespace

SmoothEdges::SmoothEdges(const PatchSet& scene) {
  for (const Primitive& p : scene.primitives)
    for (int edge = 0; edge < 4 && p.shape == Primitive::Shape::quad; ++edge)
      if (const std::uint64_t key = edge_key(p, edge)) ++count_[key];
}

bool SmoothEdges::is_smooth(const Primitive& primitive, int edge) const {
  const std::uint64_t key = edge_key(primitive, edge);
  return key != 0 && count_.at(key) > 1;
}

bool SmoothEdges::is_smooth(const Primitive& primitive) const {
  if (primitive.shape == Primitive::Shape::sphere) return false;
  return is_smooth(primitive, 0) || is_smooth(primitive, 1) || is_smooth(primitive, 2) || is_smooth(primitive, 3);
}

void add_display_vertices(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup,
                          const SmoothEdges& smooth, DisplayMesh& mesh) {
  Vertices(scene, ray_scene, lookup, smooth, mesh).add();
}

}  // namespace patchlight

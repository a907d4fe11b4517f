#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Quadtrees that subdivide the cells of patches on which irradiance varies too fast for one value, near contacts and
/// creases, with irradiance at the corners of the leaves' faces (patches and elements: Cohen, Greenberg, Immel and
/// Brock 1986). Leaves are cut where other surfaces stand on them or cross them, so that no face lies on both sides.
struct DisplayMesh {
  struct Cell {
    std::int32_t children = -1;  ///< First of four children, in rows of growing u; -1: a leaf.
    std::int32_t face = -1;      ///< Of a leaf that is not cut; -1: none, outside of a region.
    std::int32_t cut = -1;       ///< First of the cuts through a leaf; -1: none.
  };

  /// A leaf, or a convex part of a cut leaf. Faces are the mesh's elements.
  struct Face {
    std::int32_t patch = 0;
    std::int32_t first = 0;  ///< Of its corners.
    std::int32_t count = 0;  ///< Number of its corners: 3 to kMostCorners.
    float part = 1.0f;       ///< Its area relative to its patch's.
    /// Number of vertices after its corners: in the middle of edges of a leaf that border on undivided patches.
    std::int32_t middles = 0;
  };
  static constexpr int kMostCorners = 8;

  struct Vertex {
    std::int32_t patch = 0;  ///< One of the patches that share the vertex.
    float u = 0, v = 0;      ///< Position on the patch's primitive, or on a facet of the cluster.
    std::int32_t facet = 0;  ///< Which of the cluster's.
  };

  /// A facet of a mesh, of a cluster or a patch of its own, with irradiance at some of its corners.
  struct Facet {
    std::int32_t patch = 0;
    /// In rows of growing u: a vertex; from the number of vertices on, a blend; -1: interpolated from patches.
    std::array<std::int32_t, 4> corners{-1, -1, -1, -1};
    std::int32_t facet = 0;  ///< Which of the cluster's.
  };

  /// A mean of vertices with gathered irradiance.
  struct Blend {
    std::int32_t first = 0, count = 0;  ///< In `blended`.
  };
  struct Part {
    std::int32_t vertex = 0;
    float weight = 0;  ///< Those of a blend add up to 1.
  };

  /// [patches]: root cell of each patch's cell, which the parts of a cut cell share; -1: not subdivided.
  std::vector<std::int32_t> roots;
  std::vector<Cell> cells;  ///< Parents before their children.
  std::vector<Cut> cuts;    ///< Through leaves; their sides are other cuts, ~face, or kNothing.
  std::vector<Face> faces;
  /// Vertices of the faces: of leaves that are not cut, in rows of growing u, then middles of edges; of others
  /// counter-clockwise.
  std::vector<std::int32_t> corners;
  std::vector<Facet> facets;  ///< On patches without a root cell.
  std::vector<Blend> blends{};
  std::vector<Part> blended{};

  /// In this order: vertices with gathered irradiance; vertices interpolated from patches, where they border on patches
  /// that are not subdivided; hanging vertices, the midpoints of two earlier vertices, where they border on a larger
  /// leaf.
  std::vector<Vertex> vertices;
  std::int32_t gathered = 0;                             ///< Number of vertices with gathered irradiance.
  std::vector<std::array<std::int32_t, 2>> midpoints{};  ///< The two vertices of each hanging vertex.

  std::span<const Part> parts_of(const Blend& blend) const {
    return std::span(blended).subspan(std::size_t(blend.first), std::size_t(blend.count));
  }
  std::int32_t elements() const { return std::int32_t(faces.size()); }
  std::span<const std::int32_t> corners_of(const Face& face) const {
    return std::span(corners).subspan(std::size_t(face.first), std::size_t(face.count));
  }
  std::span<const std::int32_t> middles_of(const Face& face) const {
    return std::span(corners).subspan(std::size_t(face.first + face.count), std::size_t(face.middles));
  }
};

/// Whether a mesh can be of this scene: its vertices and facets are on facets that are there.
bool fits(const DisplayMesh& mesh, const PatchSet& scene);

}  // namespace patchlight

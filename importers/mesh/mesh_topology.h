#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "importers/mesh/surface.h"

namespace patchlight {

/// Welded triangles and who meets whom.
struct MeshTopology {
  struct Triangle {
    std::array<std::int32_t, 3> vertices{};
    std::array<std::int32_t, 3> neighbors{-1, -1, -1};  ///< Across the edge from corner i to i + 1; -1: none.
    std::array<std::int32_t, 3> smooth_vertices{};      ///< Corners with the same number meet without a crease.
    Vec3d normal{0.0};                                  ///< Unit.
    double area = 0.0;                                  ///< m2
  };

  /// Triangles that edges connect.
  struct Component {
    std::vector<std::int32_t> triangles;
    bool closed = false;  ///< Every edge has two triangles, and they agree on which side is out.
  };

  std::vector<Vec3d> vertices;  ///< m
  std::vector<Triangle> triangles;
  std::vector<std::vector<Vec2f>> texcoords;  ///< By mapping, of the triangles' corners; empty where the soup has none.
  std::vector<Vec4f> colors;                  ///< Of the triangles' corners, the same.
  std::vector<Component> components;
  std::vector<Vec3f> normals;      ///< The file's, of quantized places: what is flat, these say better.
  double rounding = 0.0;           ///< m; as TriangleSoup has it.
  double texcoord_rounding = 0.0;  ///< The same.
  std::size_t without_area = 0;    ///< Triangles that were left out.
};

/// Whether two triangles of a quantized mesh can lie in one plane: the file's normals at all their corners agree, or,
/// without any, the triangles' own nearly do.
bool flat_by_normals(const MeshTopology& topology, std::int32_t a, std::int32_t b);

/// Welds corners at exactly equal positions and connects the triangles by OpenMesh.
///
/// Triangles whose height is below 1e-7 of their longest edge count as without area. Surfaces that meet in an edge of
/// more than two triangles, or in a point, stay apart. Two triangles meet smoothly across an edge if they are coplanar
/// (within 1e-3 rad), or if the file's normals agree at both its ends and the edge bends by less than 60 degrees.
/// Smooth numbers count up from 0.
MeshTopology build_topology(const TriangleSoup& soup);

}  // namespace patchlight

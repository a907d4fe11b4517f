#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "importers/mesh/surface.h"

namespace patchlight {

/// Triangles with shared vertices and their adjacency.
struct MeshTopology {
  struct Triangle {
    std::array<std::int32_t, 3> vertices{};
    std::array<std::int32_t, 3> neighbors{-1, -1, -1};  ///< Across the edge from corner i to i + 1; -1: boundary.
    std::array<std::int32_t, 3>
        smooth_vertices{};  ///< Corners with equal numbers share irradiance; a crease separates others.
    Vec3d normal{0.0};      ///< Unit.
    double area = 0.0;      ///< m2
  };

  /// Triangles connected through edges.
  struct Component {
    std::vector<std::int32_t> triangles;
    bool closed = false;  ///< Every edge has two triangles of consistent winding.
  };

  std::vector<Vec3d> vertices;  ///< m
  std::vector<Triangle> triangles;
  std::vector<std::vector<Vec2f>> texcoords;  ///< By mapping and corner, 3 per triangle; empty where the soup has none.
  std::vector<Vec4f> colors;                  ///< By corner, 3 per triangle; empty where the soup has none.
  std::vector<Component> components;
  std::vector<Vec3f>
      normals;             ///< The file's, by corner, 3 per triangle; zeros where it has none that fit the triangle.
  double rounding = 0.0;   ///< m; as in TriangleSoup.
  bool quantized = false;  ///< As in TriangleSoup.
  double texcoord_rounding = 0.0;        ///< As in TriangleSoup.
  std::size_t degenerate_triangles = 0;  ///< Omitted.
  std::size_t added_triangles = 0;       ///< By splitting at vertices on open edges.
  std::size_t normals_behind = 0;        ///< Normals of the file that point behind their triangle.
};

/// Whether two triangles can be coplanar by their normals: for a quantized mesh, the file's normals at all their
/// corners agree, or, without normals in the file, their geometric normals nearly do. True for other meshes.
bool flat_by_normals(const MeshTopology& topology, std::int32_t a, std::int32_t b);

/// Makes one vertex of all corners at the same position, and of vertices of open edges at the same position within the
/// file's precision (with_closed_seams()); splits open edges at the vertices on them (split_at_t_vertices()); connects
/// the triangles by OpenMesh's half-edges.
///
/// Triangles whose height is below 1e-7 of their longest edge are degenerate. Surfaces that touch in a non-manifold
/// edge or in a single vertex are not connected. An edge is smooth if its triangles are coplanar (within 1e-3 rad), or
/// if the file's normals agree at both its ends and the dihedral angle is below 60 degrees; otherwise it is a crease.
/// Smooth vertices are numbered from 0.
MeshTopology build_topology(const TriangleSoup& soup);

}  // namespace patchlight

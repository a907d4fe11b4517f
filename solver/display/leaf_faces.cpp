#include "solver/display/leaf_faces.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pipeline/model/cuts/cut_cells.h"
#include "pipeline/optics/cuts/cell_cutter.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/transport/face_lookup.h"
#include "solver/display/display_vertices.h"

namespace patchlight {

namespace {

constexpr double kSmall = 0.1;          // extent of crossings that do not cut, over the size of a leaf
constexpr double kSmallestPart = 1e-9;  // of a patch; faces have an area
constexpr double kMargin = 1e-3;        // around a leaf, over its size, in which crossings are looked for

/// A plane primitive with crossings.
struct Plane {
  PlaneFrame frame;
  SectorFinder sectors;
  double rounding;  ///< Error of positions, m.
};

/// Distance of a polygon's corner from the edges that do not end there, m.
double room_at(const Polygon& polygon, const Vec2d& corner) {
  double room = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    if (a != corner && b != corner) room = std::min(room, std::abs(side_of(a, b, corner)) / (b - a).length());
  }
  return room;
}

class Faces {
 public:
  Faces(const PatchSet& scene, const PatchLookup& lookup, const SmoothEdges& smooth,
        const std::vector<std::vector<Crossing>>& crossings, const std::vector<bool>& is_open, DisplayMesh& mesh)
      : scene_(scene),
        lookup_(lookup),
        crossings_(crossings),
        mesh_(mesh),
        vertices_(scene, lookup, smooth, is_open, mesh),
        planes_(scene.primitives.size()) {}

  void add() {
    std::vector<Leaf> leaves = find_leaves(scene_, lookup_, mesh_);
    for (const Leaf& leaf : leaves) {
      add_plane(scene_.patches[leaf.patch]);
      add_faces(leaf);
    }
    vertices_.move_off_edges();
    std::stable_sort(leaves.begin(), leaves.end(), [](const Leaf& a, const Leaf& b) { return a.size > b.size; });
    for (const Leaf& leaf : leaves) find_midpoints(leaf);
    vertices_.sort();
    set_parts();
  }

 private:
  void add_plane(const Patch& patch) {
    std::optional<Plane>& plane = planes_[patch.primitive];
    if (plane || crossings_[patch.primitive].empty()) return;
    const Primitive& primitive = scene_.primitives[patch.primitive];
    const PlaneFrame frame = *PlaneFrame::of(primitive);
    const double size = std::sqrt(area_of(cell_polygon(primitive, frame, patch)));
    const double rounding = position_rounding(primitive);
    plane.emplace(Plane{frame, SectorFinder(primitive, frame, thinnest_part(size, rounding)), rounding});
  }

  void add_faces(const Leaf& leaf) {
    const std::int32_t primitive = scene_.patches[leaf.patch].primitive;
    if (planes_[primitive]) {
      cut_leaf(leaf, *planes_[primitive]);
      return;
    }
    mesh_.cells[leaf.cell].face = add_face(leaf.patch, 4);
    for (int k = 0; k < 4; ++k) {
      const VertexKey node = leaf.corner(k);
      mesh_.corners.push_back(vertices_.at(node, leaf, leaf.patch, leaf.uv(node)));
    }
  }

  void cut_leaf(const Leaf& leaf, const Plane& plane) {
    DisplayMesh::Cell& cell = mesh_.cells[leaf.cell];
    std::array<Vec2d, 4> corners;
    Polygon polygon;
    for (const int k : {0, 1, 3, 2}) {
      corners[k] = place(leaf, plane, leaf.corner(k));
      if (polygon.empty() || (corners[k] != polygon.back() && corners[k] != polygon.front()))
        polygon.push_back(corners[k]);
    }
    const std::vector<Crossing> near = near_crossings(leaf, plane, polygon);
    const CellParts parts = CellCutter(near, kSmall, plane.rounding).cut(polygon);
    if (parts.cuts.empty()) {
      cell.face = add_face(patch_at(leaf, plane, polygon), 4);
      for (int k = 0; k < 4; ++k) add_corner(leaf, plane, leaf.corner(k), corners[k], near, polygon);
      return;
    }
    const auto first_face = mesh_.elements(), first_cut = std::int32_t(mesh_.cuts.size());
    cell.cut = first_cut;
    for (const Cut& of_leaf : parts.cuts) {
      Cut& cut = mesh_.cuts.emplace_back(of_leaf);
      for (std::int32_t& side : cut.sides) side = side >= 0 ? first_cut + side : ~(first_face + ~side);
    }
    for (const Polygon& part : parts.parts) {
      add_face(patch_at(leaf, plane, part), int(part.size()));
      for (const Vec2d& corner : part) {
        const auto at = std::find(corners.begin(), corners.end(), corner);
        const VertexKey on_cut{~scene_.patches[leaf.patch].primitive, std::llround(corner.x / plane.rounding),
                               std::llround(corner.y / plane.rounding)};
        add_corner(leaf, plane, at != corners.end() ? leaf.corner(int(at - corners.begin())) : on_cut, corner, near,
                   part);
      }
    }
  }

  std::int32_t add_face(std::int32_t patch, int count) {
    mesh_.faces.push_back({patch, std::int32_t(mesh_.corners.size()), count});
    return mesh_.elements() - 1;
  }

  /// Adds a corner to the last face, whose polygon is given.
  void add_corner(const Leaf& leaf, const Plane& plane, VertexKey key, const Vec2d& at,
                  const std::vector<Crossing>& near, const Polygon& face) {
    Surroundings around{plane.sectors.around(at, near), 0, room_at(face, at)};
    around.sector = key.sector = around.sectors.of(centroid_of(face) - at);
    Vec2f uv = leaf.uv(key);
    if (key.grid < 0)
      uv = Vec2f(uv_of(scene_.primitives[scene_.patches[leaf.patch].primitive], plane.frame.to_world(at)));
    mesh_.corners.push_back(vertices_.at(key, leaf, mesh_.faces.back().patch, uv, around));
  }

  /// The patch on which a part of a leaf lies.
  std::int32_t patch_at(const Leaf& leaf, const Plane& plane, const Polygon& part) const {
    const Imath::V2d uv =
        uv_of(scene_.primitives[scene_.patches[leaf.patch].primitive], plane.frame.to_world(centroid_of(part)));
    return lookup_.part_of_cell(leaf.patch, float(uv.x), float(uv.y));
  }

  Vec2d place(const Leaf& leaf, const Plane& plane, const VertexKey& node) const {
    const Vec2f uv = leaf.uv(node);
    return plane.frame.to_plane(
        position_at(scene_.primitives[scene_.patches[leaf.patch].primitive].corners, uv.x, uv.y));
  }

  std::vector<Crossing> near_crossings(const Leaf& leaf, const Plane& plane, const Polygon& polygon) const {
    Imath::Box2d box;
    for (const Vec2d& corner : polygon) box.extendBy(corner);
    const Vec2d margin = box.size() * kMargin + Vec2d(plane.rounding);
    box.extendBy(box.min - margin);
    box.extendBy(box.max + margin);
    const auto& crossings = crossings_[scene_.patches[leaf.patch].primitive];
    const CellCutter cutter(crossings, kSmall, plane.rounding);
    const double size = std::sqrt(area_of(polygon));
    std::vector<Crossing> near;
    for (const Crossing& crossing : crossings) {
      Imath::Box2d of_crossing(crossing.from);
      of_crossing.extendBy(crossing.to);
      if (of_crossing.intersects(box) && cutter.counts(crossing, size)) near.push_back(crossing);
    }
    return near;
  }

  void find_midpoints(const Leaf& leaf) {
    if (mesh_.cells[leaf.cell].cut >= 0) return;
    const std::int32_t primitive = scene_.patches[leaf.patch].primitive;
    const std::optional<Plane>& plane = planes_[primitive];
    std::vector<Crossing> near;
    Vec2d middle(0.0);
    if (plane) {
      Polygon polygon;
      for (const int k : {0, 1, 3, 2}) polygon.push_back(place(leaf, *plane, leaf.corner(k)));
      near = near_crossings(leaf, *plane, polygon);
      middle = (polygon[0] + polygon[2]) * 0.5;
    }
    const auto sector_of = [&](const VertexKey& node) {
      if (!plane) return 0;
      const Vec2d at = place(leaf, *plane, node);
      return plane->sectors.around(at, near).of(middle - at);
    };
    const auto corners = mesh_.corners_of(mesh_.faces[mesh_.cells[leaf.cell].face]);
    for (const auto& [a, b] : {std::pair(0, 1), {1, 3}, {2, 3}, {0, 2}})
      vertices_.find_midpoints(leaf.corner(a), leaf.corner(b), corners[a], corners[b], sector_of);
  }

  void set_parts() {
    const std::vector<Patch> parts = face_patches(scene_, mesh_);
    for (std::size_t f = 0; f < parts.size(); ++f) {
      DisplayMesh::Face& face = mesh_.faces[f];
      face.part = float(std::clamp(parts[f].area / scene_.patches[face.patch].area, kSmallestPart, 1.0));
    }
  }

  const PatchSet& scene_;
  const PatchLookup& lookup_;
  const std::vector<std::vector<Crossing>>& crossings_;
  DisplayMesh& mesh_;
  DisplayVertices vertices_;
  std::vector<std::optional<Plane>> planes_;  ///< [primitives]
};

}  // namespace

void add_faces(const PatchSet& scene, const PatchLookup& lookup, const SmoothEdges& smooth,
               const std::vector<std::vector<Crossing>>& crossings, const std::vector<bool>& is_open,
               DisplayMesh& mesh) {
  Faces(scene, lookup, smooth, crossings, is_open, mesh).add();
}

}  // namespace patchlight

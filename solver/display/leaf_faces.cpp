#include "solver/display/leaf_faces.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pipeline/model/cuts/cut_cells.h"
#include "pipeline/model/cuts/region_shape.h"
#include "pipeline/optics/cuts/cell_cutter.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/transport/face_lookup.h"
#include "solver/display/display_vertices.h"

namespace patchlight {

namespace {

constexpr double kSmall = 0.1;          // extent of crossings that do not cut, over the size of a leaf
constexpr double kInside = 1e-3;        // part of a face's area that lies in its region
constexpr double kSmallestPart = 1e-9;  // of a patch; faces have an area
constexpr double kSamePoint = 0.05;     // of a leaf: distance of vertices of two quads that are one
constexpr double kMargin = 1e-3;        // around a leaf, over its size, in which crossings are looked for

/// A plane primitive whose leaves may be cut.
struct Plane {
  PlaneFrame frame;
  SectorFinder sectors;
  double rounding;                    ///< Error of positions, m.
  std::optional<RegionShape> region;  ///< Empty: all of the quad.

  /// Whether there is anything of a polygon.
  bool holds(const Polygon& polygon) const {
    return !region || patchlight::area_of(region->inside(polygon)) > kInside * patchlight::area_of(polygon);
  }
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
  Faces(const PatchSet& scene, const PatchLookup& lookup, const Lattices& lattices, const Seams& seams,
        const SmoothEdges& smooth, const std::vector<std::vector<Crossing>>& crossings,
        const std::vector<bool>& is_open, DisplayMesh& mesh)
      : scene_(scene),
        lookup_(lookup),
        lattices_(lattices),
        seams_(seams),
        points_(seams.rounding()),
        crossings_(crossings),
        mesh_(mesh),
        vertices_(scene, lookup, lattices, smooth, is_open, mesh),
        planes_(scene.primitives.size()) {}

  void add() {
    std::vector<Leaf> leaves = find_leaves(scene_, lookup_, lattices_, mesh_);
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
    plane.emplace(Plane{frame, SectorFinder(primitive, frame, thinnest_part(size, rounding)), rounding, {}});
    if (primitive.region) plane->region.emplace(primitive, frame);
  }

  void add_faces(const Leaf& leaf) {
    const std::int32_t primitive = scene_.patches[leaf.patch].primitive;
    if (planes_[primitive]) {
      cut_leaf(leaf, *planes_[primitive]);
      return;
    }
    mesh_.cells[leaf.cell].face = add_face(leaf.patch, 4);
    for (int k = 0; k < 4; ++k) {
      const Leaf::Node node = leaf.corner(k);
      mesh_.corners.push_back(vertices_.at(key_at(leaf, node, leaf.size), leaf, leaf.patch, leaf.uv(node)));
    }
    add_middles(leaf, nullptr, {});
  }

  /// Adds vertices to the last face, of a leaf that is not cut, in the middle of the edges that border on undivided
  /// patches, between whose centres irradiance is interpolated. `plane`: the quad's, if it has crossings; `near`:
  /// these.
  void add_middles(const Leaf& leaf, const Plane* plane, const std::vector<Crossing>& near) {
    const std::int32_t i = scene_.patches[leaf.patch].primitive;
    if (leaf.size != kFinestCells || scene_.primitives[i].shape == Primitive::Shape::sphere) return;
    const auto column = int(leaf.at.x / kFinestCells), row = int(leaf.at.y / kFinestCells);
    constexpr std::array<std::array<int, 4>, 4> kEdges{{{0, 1, 0, -1}, {1, 3, 1, 0}, {2, 3, 0, 1}, {0, 2, -1, 0}}};
    for (int k = 0; k < 4; ++k) {
      const auto& [from, to, across_u, across_v] = kEdges[k];
      const int x = column + across_u, y = row + across_v;
      const bool inside = x >= 0 && y >= 0 && x < lookup_.row(i, 0).cells && y < lookup_.rows(i);
      const std::int32_t next = inside ? lookup_.at(lookup_.row(i, y), x) : lattices_.beyond(i, x, y);
      if (next < 0 || mesh_.roots[next] >= 0 || lookup_.closed_edges(leaf.patch) >> k & 1) continue;
      const Leaf::Node a = leaf.corner(from), b = leaf.corner(to), middle{(a.x + b.x) / 2, (a.y + b.y) / 2};
      if (plane && plane->sectors.around(place(leaf, *plane, middle), near).parted()) continue;
      mesh_.corners.push_back(vertices_.at(key_at(leaf, middle, leaf.size), leaf, leaf.patch, leaf.uv(middle)));
      ++mesh_.faces.back().middles;
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
    if (!plane.holds(polygon)) return;
    const std::vector<Crossing> near = near_crossings(leaf, plane, polygon);
    const CellParts parts = CellCutter(near, kSmall, plane.rounding).cut(polygon);
    if (parts.cuts.empty()) {
      cell.face = add_face(patch_at(leaf, plane, polygon), 4);
      for (int k = 0; k < 4; ++k) add_corner(leaf, plane, k, corners[k], near, polygon);
      add_middles(leaf, &plane, near);
      return;
    }
    const auto first_cut = std::int32_t(mesh_.cuts.size());
    std::vector<std::int32_t> faces;  // of the parts; -1: none
    std::int32_t next = mesh_.elements();
    for (const Polygon& part : parts.parts) faces.push_back(plane.holds(part) ? next++ : -1);
    if (next == mesh_.elements()) return;
    cell.cut = first_cut;
    for (const Cut& of_leaf : parts.cuts) {
      Cut& cut = mesh_.cuts.emplace_back(of_leaf);
      for (std::int32_t& side : cut.sides)
        side = side >= 0 ? first_cut + side : faces[~side] >= 0 ? ~faces[~side] : Cut::kNothing;
    }
    for (const Polygon& part : parts.parts) {
      if (faces[std::size_t(&part - parts.parts.data())] < 0) continue;
      add_face(patch_at(leaf, plane, part), int(part.size()));
      for (const Vec2d& corner : part) {
        const auto at = std::find(corners.begin(), corners.end(), corner);
        add_corner(leaf, plane, at != corners.end() ? int(at - corners.begin()) : -1, corner, near, part);
      }
    }
  }

  std::int32_t add_face(std::int32_t patch, int count) {
    mesh_.faces.push_back({patch, std::int32_t(mesh_.corners.size()), count});
    return mesh_.elements() - 1;
  }

  /// Adds a corner to the last face, whose polygon is given. `k`: the leaf's corner that it is, or -1.
  void add_corner(const Leaf& leaf, const Plane& plane, int k, const Vec2d& at, const std::vector<Crossing>& near,
                  const Polygon& face) {
    Surroundings around{plane.sectors.around(at, near), 0, room_at(face, at)};
    around.sector = around.sectors.of(centroid_of(face) - at);
    const std::int32_t primitive = scene_.patches[leaf.patch].primitive;
    const bool on_node = k >= 0 && !around.sectors.parted();
    const VertexKey key =
        on_node ? key_at(leaf, leaf.corner(k), leaf.size) : parted_key(primitive, plane, at, around.sector);
    const Vec2f uv =
        k >= 0 ? leaf.uv(leaf.corner(k)) : Vec2f(uv_of(scene_.primitives[primitive], plane.frame.to_world(at)));
    mesh_.corners.push_back(vertices_.at(key, leaf, mesh_.faces.back().patch, uv, around));
  }

  /// The key of a vertex at a node of a leaf: shared with all quads around it, unless anything stands between some.
  /// `size`: distance to other vertices, in finest cells.
  VertexKey key_at(const Leaf& leaf, const Leaf::Node& node, int size) {
    const std::int32_t i = scene_.patches[leaf.patch].primitive;
    if (leaf.lattice == leaf.grid && lattices_.empty() && !seams_.has(i)) return leaf.key(node, false);
    const std::int64_t columns = lookup_.row(i, 0).cells, rows = lookup_.rows(i);
    const bool inside = node.x > 0 && node.y > 0 && node.x < columns * kFinestCells && node.y < rows * kFinestCells;
    if (!inside && seams_.has(i)) return key_on_outline(leaf, node, size);
    bool shared = true;
    for (const std::int64_t y : {node.y - 1, node.y})
      for (const std::int64_t x : {node.x - 1, node.x}) {
        const std::int64_t column = x < 0 ? -1 : x / kFinestCells, row = y < 0 ? -1 : y / kFinestCells;
        if (column < 0 || column >= columns || row < 0 || row >= rows)
          shared = shared && lattices_.beyond(i, int(column), int(row)) >= 0;
      }
    return leaf.key(node, shared);
  }

  /// The key of a vertex on the outline of a quad that has seams: of its position, unless anything stands there.
  VertexKey key_on_outline(const Leaf& leaf, const Leaf::Node& node, int size) {
    const std::int32_t i = scene_.patches[leaf.patch].primitive;
    const auto& corners = scene_.primitives[i].corners;
    const PlaneFrame frame = *PlaneFrame::of(scene_.primitives[i]);
    const Vec2f uv = leaf.uv(node);
    const Vec3d point = position_at(corners, uv.x, uv.y);
    if (!seams_.is_open(i, frame.to_plane(point))) return leaf.key(node, false);
    const double u = leaf.step.x * (corners[1] - corners[0]).length(),
                 v = leaf.step.y * (corners[3] - corners[0]).length();
    const double near = kSamePoint * size * std::min(u, v);
    return {VertexKey::kOfPoints, points_.number(point, frame.normal(), std::min(near, seams_.rounding()))};
  }

  /// The key of a vertex on a cut, or where other surfaces stand: no other primitive shares it.
  static VertexKey parted_key(std::int32_t primitive, const Plane& plane, const Vec2d& at, int sector) {
    return {~primitive, std::llround(at.x / plane.rounding), std::llround(at.y / plane.rounding), sector};
  }

  /// The patch on which a part of a leaf lies.
  std::int32_t patch_at(const Leaf& leaf, const Plane& plane, const Polygon& part) const {
    const Imath::V2d uv =
        uv_of(scene_.primitives[scene_.patches[leaf.patch].primitive], plane.frame.to_world(centroid_of(part)));
    return lookup_.part_of_cell(leaf.patch, float(uv.x), float(uv.y));
  }

  Vec2d place(const Leaf& leaf, const Plane& plane, const Leaf::Node& node) const {
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
    if (mesh_.cells[leaf.cell].face < 0) return;
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
    const auto key_of = [&](const Leaf::Node& node, int size) {
      if (!plane) return key_at(leaf, node, size);
      const Vec2d at = place(leaf, *plane, node);
      const Sectors sectors = plane->sectors.around(at, near);
      return sectors.parted() ? parted_key(primitive, *plane, at, sectors.of(middle - at)) : key_at(leaf, node, size);
    };
    const auto corners = mesh_.corners_of(mesh_.faces[mesh_.cells[leaf.cell].face]);
    for (const auto& [a, b] : {std::pair(0, 1), {1, 3}, {2, 3}, {0, 2}})
      vertices_.find_midpoints(leaf.corner(a), leaf.corner(b), corners[a], corners[b], key_of);
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
  const Lattices& lattices_;
  const Seams& seams_;
  SharedPoints points_;
  const std::vector<std::vector<Crossing>>& crossings_;
  DisplayMesh& mesh_;
  DisplayVertices vertices_;
  std::vector<std::optional<Plane>> planes_;  ///< [primitives]
};

}  // namespace

void add_faces(const PatchSet& scene, const PatchLookup& lookup, const Lattices& lattices, const Seams& seams,
               const SmoothEdges& smooth, const std::vector<std::vector<Crossing>>& crossings,
               const std::vector<bool>& is_open, DisplayMesh& mesh) {
  Faces(scene, lookup, lattices, seams, smooth, crossings, is_open, mesh).add();
}

}  // namespace patchlight

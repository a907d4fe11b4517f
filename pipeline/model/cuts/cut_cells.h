#pragma once
#include <utility>

#include "pipeline/model/cuts/plane_frame.h"
#include "pipeline/model/cuts/polygon.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// The corners of the cell that a patch is, or is a part of.
Polygon cell_polygon(const Primitive& quad, const PlaneFrame& frame, const Patch& patch);

/// A Cut in the (u,v) of its primitive.
struct CutLine {
  float constant = 0, along_u = 0, along_v = 0, twist = 0;  ///< Distance to its left, m, which is bilinear in u and v.
  std::array<std::int32_t, 2> sides{0, 0};                  ///< As in Cut.

  /// What lies at (u,v): the index into `sides`.
  int side(float u, float v) const { return constant + u * along_u + v * (along_v + u * twist) < 0; }
};

/// Sets the lines of all cuts through a cell of a plane primitive, whose first is `root`. `lines`: as `cuts`, but that
/// both sides have what lies on one of them where there is nothing on the other.
void set_lines(const std::vector<Cut>& cuts, std::int32_t root, const Primitive& quad, const PlaneFrame& frame,
               std::vector<CutLine>& lines);

/// Calls act(polygon, number) for each part of a cell, where `root` is the first of the cuts through it, and ~number
/// the side of a cut; not for what is nothing.
template <class Act>
void for_each_part(const std::vector<Cut>& cuts, std::int32_t root, Polygon cell, Act act) {
  std::vector<std::pair<Polygon, std::int32_t>> todo{{std::move(cell), root}};
  while (!todo.empty()) {
    const auto [polygon, at] = std::move(todo.back());
    todo.pop_back();
    if (at == Cut::kNothing) continue;
    if (at < 0) {
      act(polygon, ~at);
      continue;
    }
    std::array<Polygon, 2> parts = split(polygon, cuts[at].from, cuts[at].to);
    for (int side = 0; side < 2; ++side) todo.emplace_back(std::move(parts[side]), cuts[at].sides[side]);
  }
}

/// Whether convex polygons tile a whole cell.
bool fill(const std::vector<Polygon>& polygons, const Polygon& cell);

/// Makes a patch the part of its cell that convex polygons tile: its triangles and its area, and its centre on them.
void set_part(const std::vector<Polygon>& polygons, const PlaneFrame& frame, Patch& patch);

/// Sets the triangles of all patches that are parts of cells and have none.
void set_triangles(PatchSet& scene);

}  // namespace patchlight

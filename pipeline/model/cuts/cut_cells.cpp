#include "pipeline/model/cuts/cut_cells.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "pipeline/model/cuts/region_shape.h"

namespace patchlight {

Polygon cell_polygon(const Primitive& quad, const PlaneFrame& frame, const Patch& patch) {
  Polygon polygon;
  polygon.reserve(4);
  for (const auto& [u, v] :
       {std::pair(patch.u0, patch.v0), {patch.u1, patch.v0}, {patch.u1, patch.v1}, {patch.u0, patch.v1}}) {
    const Vec2d corner = frame.to_plane(position_at(quad.corners, u, v));
    if (polygon.empty() || (corner != polygon.back() && corner != polygon.front())) polygon.push_back(corner);
  }
  return polygon;
}

void set_lines(const std::vector<Cut>& cuts, std::int32_t root, const Primitive& quad, const PlaneFrame& frame,
               std::vector<CutLine>& lines) {
  std::vector<std::int32_t> todo{root};
  for (std::size_t next = 0; next < todo.size(); ++next) {
    const std::int32_t i = todo[next];
    const Cut& cut = cuts[i];
    std::array<double, 4> at;
    const double length = (cut.to - cut.from).length();
    for (int k = 0; k < 4; ++k) at[k] = side_of(cut.from, cut.to, frame.to_plane(quad.corners[k])) / length;
    lines[i] = {float(at[0]), float(at[1] - at[0]), float(at[3] - at[0]), float(at[0] - at[1] + at[2] - at[3]),
                cut.sides};
    std::copy_if(cut.sides.begin(), cut.sides.end(), std::back_inserter(todo),
                 [](std::int32_t side) { return side >= 0; });
  }
  for (std::size_t k = todo.size(); k-- > 0;) {  // from the leaves of the tree to its root
    auto& [left, right] = lines[todo[k]].sides;
    for (std::int32_t* side : {&left, &right})
      if (*side >= 0 && lines[*side].sides[0] == Cut::kNothing) *side = Cut::kNothing;
    if (left == Cut::kNothing) left = right;
    if (right == Cut::kNothing) right = left;
  }
}

namespace {

/// The corners of triangles that tile convex polygons.
std::vector<Vec3d> triangles_of(const std::vector<Polygon>& polygons, const PlaneFrame& frame) {
  std::vector<Vec3d> triangles;
  for (const Polygon& polygon : polygons)
    for (std::size_t k = 2; k < polygon.size(); ++k)
      for (const std::size_t corner : {std::size_t(0), k - 1, k}) triangles.push_back(frame.to_world(polygon[corner]));
  return triangles;
}

bool is_inside(const Polygon& polygon, const Vec2d& point) {
  for (std::size_t k = 0; k < polygon.size(); ++k)
    if (side_of(polygon[k], polygon[(k + 1) % polygon.size()], point) < 0) return false;
  return true;
}

}  // namespace

bool fill(const std::vector<Polygon>& polygons, const Polygon& cell) {
  constexpr double kWhole = 1 - 1e-9;  // part of the area
  return area_of(polygons) >= kWhole * area_of(cell);
}

void set_part(const std::vector<Polygon>& polygons, const PlaneFrame& frame, Patch& patch) {
  patch.triangles = triangles_of(polygons, frame);
  patch.area = area_of(polygons);
  if (!(patch.area > 0)) return;
  Vec2d middle(0.0);
  const Polygon* largest = &polygons[0];
  for (const Polygon& polygon : polygons) {
    middle += centroid_of(polygon) * (area_of(polygon) / patch.area);
    if (area_of(polygon) > area_of(*largest)) largest = &polygon;
  }
  const auto holds_it = [&](const Polygon& polygon) { return is_inside(polygon, middle); };
  if (std::none_of(polygons.begin(), polygons.end(), holds_it)) middle = centroid_of(*largest);
  patch.center = frame.to_world(middle);
}

void set_triangles(PatchSet& scene) {
  std::optional<RegionShape> shape;
  std::optional<PlaneFrame> frame;
  std::int32_t last = -1;  // primitive
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    Patch& patch = scene.patches[i];
    const Primitive& primitive = scene.primitives[patch.primitive];
    if ((patch.cut < 0 && !primitive.region) || !patch.triangles.empty()) continue;
    if (std::exchange(last, patch.primitive) != patch.primitive) {
      frame = PlaneFrame::of(primitive);
      shape.reset();
      if (primitive.region) shape.emplace(primitive, *frame);
    }
    const Polygon cell = cell_polygon(primitive, *frame, patch);
    if (patch.cut < 0) {
      const std::vector<Polygon> parts = shape->inside(cell);
      if (!fill(parts, cell)) patch.triangles = triangles_of(parts, *frame);
      if (parts.empty()) patch.triangles.assign(3, patch.center);  // no area, and so not the whole cell
      continue;
    }
    for_each_part(scene.cuts, patch.cut, cell, [&](const Polygon& polygon, std::int32_t part) {
      scene.patches[part].triangles =
          triangles_of(shape ? shape->inside(polygon) : std::vector<Polygon>{polygon}, *frame);
    });
  }
}

}  // namespace patchlight

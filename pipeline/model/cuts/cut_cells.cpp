#include "pipeline/model/cuts/cut_cells.h"

namespace patchlight {

Polygon cell_polygon(const Primitive& quad, const PlaneFrame& frame, const Patch& patch) {
  Polygon polygon;
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
  while (!todo.empty()) {
    const std::int32_t i = todo.back();
    todo.pop_back();
    if (i < 0) continue;
    const Cut& cut = cuts[i];
    std::array<double, 4> at;
    const double length = (cut.to - cut.from).length();
    for (int k = 0; k < 4; ++k) at[k] = side_of(cut.from, cut.to, frame.to_plane(quad.corners[k])) / length;
    lines[i] = {float(at[0]), float(at[1] - at[0]), float(at[3] - at[0]), float(at[0] - at[1] + at[2] - at[3]),
                cut.sides};
    todo.insert(todo.end(), cut.sides.begin(), cut.sides.end());
  }
}

void set_outlines(PatchSet& scene) {
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    const Patch& patch = scene.patches[i];
    if (patch.cut < 0 || !patch.outline.empty()) continue;
    const Primitive& primitive = scene.primitives[patch.primitive];
    const PlaneFrame frame = *PlaneFrame::of(primitive);
    for_each_part(scene.cuts, patch.cut, cell_polygon(primitive, frame, patch),
                  [&](const Polygon& polygon, std::int32_t part) {
                    for (const Vec2d& corner : polygon) scene.patches[part].outline.push_back(frame.to_world(corner));
                  });
  }
}

}  // namespace patchlight

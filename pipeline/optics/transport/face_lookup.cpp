#include "pipeline/optics/transport/face_lookup.h"

#include <cmath>
#include <tuple>
#include <utility>

#include "pipeline/model/cuts/region_shape.h"
#include "pipeline/model/error.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

namespace {

/// The frame of a primitive whose leaves are cut. Throws: Error (bad_data) if it is not plane.
PlaneFrame frame_of(const Primitive& primitive) {
  const std::optional<PlaneFrame> frame = PlaneFrame::of(primitive);
  if (!frame)
    throw Error(ExitCode::bad_data, "the display solution cuts a surface that is not plane", "", "solve again");
  return *frame;
}

/// Sets the part of a cell of a region that lies in it. `whole`: the patch that the cell is a part of.
void set_part_of_region(const Primitive& primitive, const Patch& whole, Patch& cell) {
  if (whole.cut < 0 && whole.triangles.empty()) return;
  const PlaneFrame frame = frame_of(primitive);
  const Polygon polygon = cell_polygon(primitive, frame, cell);
  std::vector<Polygon> parts;
  if (whole.cut >= 0) {
    parts = RegionShape(primitive, frame).inside(polygon);
  } else {
    for (std::size_t k = 0; k < whole.triangles.size(); k += 3) {
      const auto at = [&](std::size_t corner) { return frame.to_plane(whole.triangles[k + corner]); };
      Polygon part = intersection({at(0), at(1), at(2)}, polygon);
      if (part.size() >= 3 && area_of(part) > 0) parts.push_back(std::move(part));
    }
  }
  if (!fill(parts, polygon)) set_part(parts, frame, cell);
}

/// Calls act(leaf, part) for each leaf. `part_of` makes the part of a root cell from its patch, `quarters_of` those of
/// a cell's children.
template <class PartOf, class QuartersOf, class Act>
void visit_leaves(const PatchSet& scene, const DisplayMesh& mesh, PartOf part_of, QuartersOf quarters_of, Act act) {
  std::vector<bool> visited(mesh.cells.size());
  std::vector<std::pair<std::int32_t, decltype(part_of(scene.patches[0]))>> todo;
  for (std::size_t i = 0; i < mesh.roots.size(); ++i) {
    const std::int32_t root = mesh.roots[i];
    if (root < 0 || visited[root]) continue;
    visited[root] = true;
    todo.emplace_back(root, part_of(scene.patches[i]));
    while (!todo.empty()) {
      const auto [index, part] = std::move(todo.back());
      todo.pop_back();
      const DisplayMesh::Cell& cell = mesh.cells[index];
      if (cell.children < 0) {
        act(cell, part);
        continue;
      }
      const auto parts = quarters_of(part);
      for (int k = 0; k < 4; ++k) todo.emplace_back(cell.children + k, parts[k]);
    }
  }
}

}  // namespace

FaceLookup::FaceLookup(const PatchSet& scene, const DisplayMesh& mesh)
    : scene_(scene), mesh_(mesh), lines_(mesh.cuts.size()) {
  if (mesh.cuts.empty()) return;
  for_each_cut_leaf(scene, mesh, [&](const DisplayMesh::Cell& leaf, const Patch& part) {
    const Primitive& primitive = scene.primitives[part.primitive];
    set_lines(mesh.cuts, leaf.cut, primitive, frame_of(primitive), lines_);
  });
}

Patch sub_patch(const PatchSet& scene, const Patch& patch, float u0, float v0, float u1, float v1) {
  const Primitive& primitive = scene.primitives[patch.primitive];
  Patch part = patch;
  part.u0 = u0;
  part.v0 = v0;
  part.u1 = u1;
  part.v1 = v1;
  part.cut = -1;
  part.triangles.clear();
  const SurfacePoint middle = point_at(primitive, 0.5 * (u0 + u1), 0.5 * (v0 + v1));
  part.center = middle.position;
  part.normal = middle.normal;
  const double across = double(u1) - u0;
  if (primitive.shape == Primitive::Shape::sphere) {
    const double radius = primitive.sphere_radius;
    part.area = 2 * kPi * radius * radius * across * (std::cos(kPi * v0) - std::cos(kPi * v1));
  } else {
    const double u = 0.5 * (u0 + u1), v = 0.5 * (v0 + v1);  // the density is linear in both
    const auto& c = primitive.corners;
    const Vec3d along_u = (c[1] - c[0]) * (1 - v) + (c[2] - c[3]) * v;
    const Vec3d along_v = (c[3] - c[0]) * (1 - u) + (c[2] - c[1]) * u;
    part.area = (along_u % along_v).length() * across * (double(v1) - v0);
  }
  if (primitive.region && part.area > 0) set_part_of_region(primitive, patch, part);
  return part;
}

std::array<Patch, 4> quarters(const PatchSet& scene, const Patch& p) {
  const float u = 0.5f * (p.u0 + p.u1), v = 0.5f * (p.v0 + p.v1);
  return {sub_patch(scene, p, p.u0, p.v0, u, v), sub_patch(scene, p, u, p.v0, p.u1, v),
          sub_patch(scene, p, p.u0, v, u, p.v1), sub_patch(scene, p, u, v, p.u1, p.v1)};
}

void for_each_leaf(const PatchSet& scene, const DisplayMesh& mesh,
                   const std::function<void(const DisplayMesh::Cell&, const Patch&)>& act) {
  visit_leaves(
      scene, mesh, [&](const Patch& p) { return p.cut < 0 ? p : sub_patch(scene, p, p.u0, p.v0, p.u1, p.v1); },
      [&](const Patch& part) { return quarters(scene, part); },
      [&](const DisplayMesh::Cell& leaf, const Patch& part) {
        if (leaf.face >= 0 || leaf.cut >= 0) act(leaf, part);
      });
}

void for_each_cut_leaf(const PatchSet& scene, const DisplayMesh& mesh,
                       const std::function<void(const DisplayMesh::Cell&, const Patch&)>& act) {
  struct Range {
    std::int32_t primitive;
    float u0, v0, u1, v1;
  };
  const auto quarters_of = [](const Range& r) {
    const float u = 0.5f * (r.u0 + r.u1), v = 0.5f * (r.v0 + r.v1);
    return std::array<Range, 4>{{{r.primitive, r.u0, r.v0, u, v},
                                 {r.primitive, u, r.v0, r.u1, v},
                                 {r.primitive, r.u0, v, u, r.v1},
                                 {r.primitive, u, v, r.u1, r.v1}}};
  };
  Patch cell;
  visit_leaves(
      scene, mesh,
      [](const Patch& p) {
        return Range{p.primitive, p.u0, p.v0, p.u1, p.v1};
      },
      quarters_of,
      [&](const DisplayMesh::Cell& leaf, const Range& range) {
        if (leaf.cut < 0) return;
        std::tie(cell.primitive, cell.u0, cell.v0, cell.u1, cell.v1) =
            std::tie(range.primitive, range.u0, range.v0, range.u1, range.v1);
        act(leaf, cell);
      });
}

std::vector<Patch> face_patches(const PatchSet& scene, const DisplayMesh& mesh) {
  std::vector<Patch> patches(mesh.faces.size());
  for_each_leaf(scene, mesh, [&](const DisplayMesh::Cell& leaf, const Patch& part) {
    if (leaf.cut < 0) {
      patches[leaf.face] = part;
      return;
    }
    const Primitive& primitive = scene.primitives[part.primitive];
    const PlaneFrame frame = frame_of(primitive);
    for_each_part(mesh.cuts, leaf.cut, cell_polygon(primitive, frame, part),
                  [&](const Polygon& polygon, std::int32_t face) {
                    const DisplayMesh::Vertex& corner = mesh.vertices[mesh.corners[mesh.faces[face].first]];
                    if (polygon.size() < 3 || area_of(polygon) <= 0) {  // so thin that it is lost in rounding
                      patches[face] = sub_patch(scene, part, corner.u, corner.v, corner.u, corner.v);
                      return;
                    }
                    Patch& patch = patches[face] = part;
                    patch.reflectance = scene.patches[mesh.faces[face].patch].reflectance;
                    set_part({polygon}, frame, patch);
                  });
  });
  return patches;
}

std::vector<Patch> vertex_patches(const PatchSet& scene, const DisplayMesh& mesh) {
  std::vector<Patch> points;
  for (const auto& vertex : std::span(mesh.vertices).first(mesh.gathered)) {
    Patch patch = scene.patches[vertex.patch];
    patch.primitive += vertex.facet;
    patch.facets = 0;
    points.push_back(sub_patch(scene, patch, vertex.u, vertex.v, vertex.u, vertex.v));
  }
  return points;
}

}  // namespace patchlight

#include "pipeline/optics/transport/elements.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

Elements::Elements(const PatchSet& scene, const RayScene& ray_scene, const DisplayMesh& mesh)
    : scene_(scene),
      lookup_(scene),
      mesh_(&mesh),
      first_sky_(std::int32_t(scene.patches.size()) + mesh.elements),
      cut_leaf_index_(mesh.cells.size(), -1) {
  struct Cell {
    std::int32_t index, primitive;
    float u0, v0, u1, v1;
  };
  std::vector<Cell> cells, cut;
  for (std::size_t i = 0; i < mesh.roots.size(); ++i)
    if (const Patch& p = scene.patches[i]; mesh.roots[i] >= 0)
      cells.push_back({mesh.roots[i], p.primitive, p.u0, p.v0, p.u1, p.v1});
  while (!cells.empty()) {
    const Cell cell = cells.back();
    cells.pop_back();
    const DisplayMesh::Cell& of = mesh.cells[cell.index];
    const float u = 0.5f * (cell.u0 + cell.u1), v = 0.5f * (cell.v0 + cell.v1);
    for (int k = 0; k < 4 && of.children >= 0; ++k)
      cells.push_back({of.children + k, cell.primitive, k % 2 ? u : cell.u0, k / 2 ? v : cell.v0, k % 2 ? cell.u1 : u,
                       k / 2 ? cell.v1 : v});
    if (of.children >= 0 || !of.cut) continue;
    cut_leaf_index_[cell.index] = std::int32_t(cut.size());
    cut.push_back(cell);
  }
  nearest_corners_.resize(cut.size());
  tbb::parallel_for(std::size_t(0), cut.size(), [&](std::size_t at) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
    const Cell& cell = cut[at];
    for (int first = 0; first < kLeafGrid * kLeafGrid; first += 4) {
      std::array<Vec2f, 4> inside, places;
      for (int k = 0; k < 4; ++k) {
        inside[k] =
            (Vec2f(float((first + k) % kLeafGrid), float((first + k) / kLeafGrid)) + Vec2f(0.5f)) / float(kLeafGrid);
        places[k] = Vec2f(cell.u0 + inside[k].x * (cell.u1 - cell.u0), cell.v0 + inside[k].y * (cell.v1 - cell.v0));
      }
      const std::uint32_t seen =
          visible_corners(scene, ray_scene, mesh, mesh.cells[cell.index], cell.primitive, places);
      for (int k = 0; k < 4; ++k) {
        const float x = inside[k].x, y = inside[k].y;
        float most = -3;
        for (int corner = 0; corner < 4; ++corner) {
          const bool hidden = mesh.vertices[mesh.cells[cell.index].corners[corner]].hidden;
          const float near = (corner % 2 ? x : 1 - x) * (corner / 2 ? y : 1 - y) +
                             float(seen >> (4 * k + corner) & 1u) - (hidden ? 2.0f : 0.0f);
          if (near > most) nearest_corners_[at][first + k] = std::uint8_t(corner);
          most = std::max(most, near);
        }
      }
    }
  });
}

std::uint32_t visible_corners(const PatchSet& scene, const RayScene& ray_scene, const DisplayMesh& mesh,
                              const DisplayMesh::Cell& leaf, std::int32_t i, std::span<const Vec2f> places) {
  constexpr float kLift = 0.02f;  // of the distance to a corner, to ignore small bumps
  const Primitive& primitive = scene.primitives[i];
  std::array<Vec3d, 4> corners;
  std::uint32_t hidden = 0;
  for (int k = 0; k < 4; ++k) {
    const DisplayMesh::Vertex& corner = mesh.vertices[leaf.corners[k]];
    corners[k] = point_at(primitive, corner.u, corner.v).position;
    hidden |= std::uint32_t(corner.hidden) << k;
  }
  RayPacket packet;
  packet.clear();
  std::uint32_t unseen = 0;
  for (int place = 0; place < int(places.size()); ++place) {
    const SurfacePoint point = point_at(primitive, places[place].x, places[place].y);
    unseen |= hidden << 4 * place;
    for (int k = 0; k < 4; ++k) {
      const Vec3f to = Vec3f(corners[k] - point.position);
      const float distance = to.length();
      if (distance <= 0) continue;
      const float lift = ray_scene.offset(i) + kLift * distance;
      packet.set_shadow(4 * place + k, ray_scene.to_local(point.position) + point.normal * lift, to / distance,
                        distance);
    }
  }
  unseen |= ray_scene.occluded(packet);
  return ~unseen & ((1u << 4 * places.size()) - 1);
}

Patch sub_patch(const PatchSet& scene, const Patch& patch, float u0, float v0, float u1, float v1) {
  const Primitive& primitive = scene.primitives[patch.primitive];
  Patch part = patch;
  part.u0 = u0;
  part.v0 = v0;
  part.u1 = u1;
  part.v1 = v1;
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
  return part;
}

std::array<Patch, 4> quarters(const PatchSet& scene, const Patch& p) {
  const float u = 0.5f * (p.u0 + p.u1), v = 0.5f * (p.v0 + p.v1);
  return {sub_patch(scene, p, p.u0, p.v0, u, v), sub_patch(scene, p, u, p.v0, p.u1, v),
          sub_patch(scene, p, p.u0, v, u, p.v1), sub_patch(scene, p, u, v, p.u1, p.v1)};
}

void for_each_leaf(const PatchSet& scene, const DisplayMesh& mesh, std::size_t patch,
                   const std::function<void(std::int32_t, const Patch&)>& act) {
  const auto visit = [&](const auto& self, std::int32_t i, const Patch& part) -> void {
    const DisplayMesh::Cell& cell = mesh.cells[i];
    if (cell.children >= 0) {
      const std::array<Patch, 4> parts = quarters(scene, part);
      for (int k = 0; k < 4; ++k) self(self, cell.children + k, parts[k]);
    } else if (!cell.cut) {
      act(cell.leaf, part);
    } else {
      for (int k = 0; k < 4; ++k) {
        const DisplayMesh::Vertex& at = mesh.vertices[cell.corners[k]];
        act(cell.leaf + k, sub_patch(scene, part, at.u, at.v, at.u, at.v));
      }
    }
  };
  if (mesh.roots[patch] >= 0) visit(visit, mesh.roots[patch], scene.patches[patch]);
}

std::vector<Patch> leaf_patches(const PatchSet& scene, const DisplayMesh& mesh) {
  std::vector<Patch> leaves(mesh.elements);
  for (std::size_t i = 0; i < mesh.roots.size(); ++i)
    for_each_leaf(scene, mesh, i, [&](std::int32_t element, const Patch& leaf) { leaves[element] = leaf; });
  return leaves;
}

}  // namespace patchlight

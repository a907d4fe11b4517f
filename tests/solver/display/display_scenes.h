#pragma once
#include <cmath>

#include "solver/display/display_mesh_builder.h"
#include "tests/patch_scene.h"

namespace patchlight::test {

inline DisplayMesh mesh_of(const PatchSet& scene) {
  const RayScene ray_scene(scene);
  std::int64_t cast = 0;
  return build_display_mesh(scene, ray_scene, PatchLookup(scene), 1, cast);
}

/// A room whose wall at +x emits, divided by a wall off the patches' edges: points with x < 0.03 are dark.
inline PatchScene divided_room() {
  PatchScene builder;
  builder.room(1, 8, {0.5f, 0.0f});
  const int wall = builder.quad({{{0.03, -1, -1}, {0.03, 1, -1}, {0.03, 1, 1}, {0.03, -1, 1}}}, 8, 8, {0.5f, 0.0f});
  const int back = builder.quad({{{0.03, -1, -1}, {0.03, -1, 1}, {0.03, 1, 1}, {0.03, 1, -1}}}, 8, 8, {0.5f, 0.0f});
  PatchSet& scene = builder.get();
  scene.primitives[wall].back = back;
  scene.primitives[back].back = wall;
  scene.primitives[1].light_group = 0;
  for (int i = 64; i < 128; ++i) scene.patches[i].emission = Color(1.0f);
  return builder;
}

/// A cylinder of `rings` rings of 16 facets around the y axis, from y = `low` to 2, above a floor; each facet is a
/// patch.
inline PatchScene drum_above_a_floor(double low, int rings, int floor_cells = 32) {
  constexpr int kAround = 16;
  PatchScene builder;
  builder.quad({{{-4, 0, -4}, {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}}}, floor_cells, floor_cells, {0.8f, 0.0f});
  const auto at = [](int k, double y) {
    return Vec3d(std::cos(2 * kPi * k / kAround), y, -std::sin(2 * kPi * k / kAround));
  };
  for (int j = 0; j < rings; ++j) {
    const double y0 = low + (2 - low) * j / rings, y1 = low + (2 - low) * (j + 1) / rings;
    for (int k = 0; k < kAround; ++k) {
      const int facet = builder.quad({{at(k, y0), at(k + 1, y0), at(k + 1, y1), at(k, y1)}}, 1, 1, {0.5f, 0.0f});
      const int next = (k + 1) % kAround;
      const Vec3f left(at(k, 0)), right(at(k + 1, 0));
      builder.get().normals.resize(std::size_t(facet), kFlatNormals);
      builder.get().normals.push_back({left, right, right, left});
      builder.get().primitives[facet].smooth_vertices = {kAround * j + k, kAround * j + next, kAround * (j + 1) + next,
                                                         kAround * (j + 1) + k};
    }
  }
  return builder;
}

}  // namespace patchlight::test

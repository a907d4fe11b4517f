#pragma once
#include "pipeline/model/transport.h"

namespace patchlight::test {

inline Transport sample_transport() {
  Transport transport;
  transport.starts = {0, 2, 4, 4, 6};  // two patches
  transport.columns = {1, 0, 1, 1, 0, 1};
  transport.hit_weights = {0.25f, 0.5f, 0.25f, 0.5f};
  transport.visible_fractions = {0.5f, 0.5f, 1.0f, 1.0f};
  transport.rays = 4;
  transport.mirrored = {{0, 1, 1, Color(0.5f, 0.25f, 0.0f)}, {1, 0, 0, Color(0.1f)}};
  transport.emitters = {{0, 1, {0.1f, 0.2f, 0.3f, -0.01f}}, {1, 1, {0.0f, 0.0f, 0.5f, 0.5f}}};
  for (auto& emitter : transport.emitters) emitter.mirrored.assign(4, Color(0.25f, 0.5f, 0.75f));
  transport.key = "key";
  return transport;
}

/// The second patch cut once, something standing on its last quarter.
inline DisplayMesh cut_patch() {
  DisplayMesh mesh;
  mesh.roots = {-1, 0};
  mesh.cells.resize(5);
  mesh.cells[0].children = 1;
  for (int k = 0; k < 3; ++k) mesh.cells[1 + k].face = k;
  mesh.cells[4].cut = 0;
  mesh.cuts = {{{0.5, 0}, {0.5, 1}, {~3, 1}}, {{0, 0.5}, {1, 0.5}, {~4, ~5}}};
  for (std::int32_t f = 0; f < 6; ++f) mesh.faces.push_back({1, 4 * f, 4, 0.25f});
  mesh.corners.resize(24, 1);
  mesh.corners[2] = 4;
  mesh.vertices = {{1, 0.5f, 0.5f}, {1, 0.6f, 0.5f}, {1, 0.7f, 0.5f}, {1, 0.5f, 0.0f}, {1, 0.5f, 0.25f}};
  mesh.gathered = 2;
  mesh.midpoints = {{0, 3}};
  mesh.facets = {{0, {1, -1, 0, 5}, 3}};
  mesh.blends = {{0, 2}};
  mesh.blended = {{0, 0.25f}, {1, 0.75f}};
  mesh.vertices[1].facet = 2;
  return mesh;
}

inline Transport sample_with_display() {
  Transport transport = sample_transport();
  transport.display = {cut_patch(), {}, {}};
  transport.display->rows.starts = {0, 1, 2, 4, 6};
  transport.display->rows.columns = {6, 7, 0, 1, 2, 3};  // 2 patches, 6 faces
  transport.display->rows.hit_weights = {1.0f, 1.0f, 0.5f, 0.5f};
  transport.display->rows.rays = 4;
  transport.display->rows.mirrored = {{1, 0, 7, Color(0.5f)}};
  for (auto& emitter : transport.emitters) emitter.display.assign(12, 0.125f);
  return transport;
}

}  // namespace patchlight::test

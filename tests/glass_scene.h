#pragma once
#include "tests/patch_scene.h"

namespace patchlight::test {

/// Adds a material of glass of index `ior` and returns its index.
inline int add_glass(PatchSet& scene, bool solid, float roughness = 0.0f, float ior = 1.5f,
                     const Color& tint = Color(1.0f)) {
  Material& glass = scene.materials.emplace_back();
  glass.name = "glass";
  glass.roughness = roughness;
  const float normal = (ior - 1) * (ior - 1) / ((ior + 1) * (ior + 1));
  glass.coat = {Color(normal), 1.0f, ior};
  glass.transmission = {1.0f, tint, solid, ior};
  return int(scene.materials.size()) - 1;
}

/// Adds a material that covers each place in part, with a mask of one opaque texel, and returns its index. Its
/// primitives need that mask.
inline int add_veil(PatchSet& scene, float alpha) {
  if (scene.masks.empty()) scene.masks.push_back({1, 1, {}, true, {255}});
  Material& veil = scene.materials.emplace_back();
  veil.name = "veil";
  veil.alpha = alpha;
  return int(scene.materials.size()) - 1;
}

/// A horizontal square about the Y axis, lit above, or below if `upwards` is false.
inline int add_level(PatchScene& builder, double y, double half, bool upwards, const PatchScene::Surface& surface,
                     int cells = 1) {
  const double s = upwards ? half : -half;
  return builder.quad({{{-s, y, half}, {s, y, half}, {s, y, -half}, {-s, y, -half}}}, cells, cells, surface);
}

/// Fresnel's reflectance from air to index `n` (Born and Wolf 1999, section 1.5).
inline double fresnel(double n, double cosine) {
  const double sine2 = (1 - cosine * cosine) / (n * n), inner = std::sqrt(1 - sine2);
  const double s = (cosine - n * inner) / (cosine + n * inner), p = (n * cosine - inner) / (n * cosine + inner);
  return 0.5 * (s * s + p * p);
}

inline Environment white_sky() {
  Environment sky;
  sky.texels.assign(1, Color(1.0f));
  sky.rows = 24;
  sky.cells.assign(2 * 24 * 24, Color(1.0f));
  return sky;
}

}  // namespace patchlight::test

#pragma once
#include "tests/patch_scene.h"

namespace patchlight::test {

/// A checkerboard mask of `count` x `count` texels; half of them are holes.
inline Texture checkers(int count) {
  Texture mask{count, count, {}, true, {}};
  for (int k = 0; k < count * count; ++k) mask.texels.push_back((k % count + k / count) % 2 == 0 ? 255 : 0);
  return mask;
}

/// Applies a mask to one side of a surface, along its (u,v). `coverage`: that of each of the primitive's patches.
inline void alpha_masked(PatchSet& scene, int primitive, const Texture& mask, float coverage) {
  scene.materials.push_back(scene.materials[std::size_t(scene.primitives[std::size_t(primitive)].material)]);
  scene.materials.back().alpha_cutoff = 0.5f;
  Primitive& p = scene.primitives[std::size_t(primitive)];
  p.material = std::int32_t(scene.materials.size()) - 1;
  p.mask = std::int32_t(scene.masks.size());
  scene.masks.push_back(mask);
  for (Patch& patch : scene.patches)
    if (patch.primitive == primitive) patch.coverage = coverage;
}

/// Makes two quads, whose u are mirrored, the two sides of one surface.
inline void make_sides(PatchSet& scene, int front, int back) {
  scene.primitives[std::size_t(front)].back = back;
  scene.primitives[std::size_t(back)].back = front;
}

}  // namespace patchlight::test

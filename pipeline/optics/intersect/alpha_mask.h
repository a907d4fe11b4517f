#pragma once
#include <cstdint>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

/// Alpha of primitive `i`, which has a mask, at (u,v): the product of the material's, the mask's and the vertices'.
float alpha_at(const PatchSet& scene, std::int32_t i, double u, double v);

/// Alpha test of primitive `i`, which has a mask, at (u,v): whether its alpha is at least the cutoff; where it covers
/// places in part, whether it exceeds `chance`, in [0,1); by default, whether there is any of it.
bool passes_alpha_test(const PatchSet& scene, std::int32_t i, double u, double v, float chance = 0.0f);

/// Whether a patch has an alpha mask and an area.
inline bool has_alpha_mask(const PatchSet& scene, const Patch& patch) {
  return scene.primitives[patch.primitive].mask >= 0 && patch.area > 0;
}

/// A point of the unit square of a masked patch that passes the alpha test: `at`, or else the first of up to 64 random
/// points that does. Maps uniform points of the square to uniform points of the covered area. If no point passes, the
/// result is in a hole.
Vec2f covered_point(const PatchSet& scene, const Patch& patch, const PatchSampler& sampler, Vec2f at,
                    std::uint64_t random);

}  // namespace patchlight

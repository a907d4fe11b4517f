#pragma once
#include <cstdint>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

/// Whether primitive `i`, which has a mask, is there at (u,v): its material's alpha times the mask's, bilinear between
/// texels, and the vertices' is no less than the cutoff.
bool passes_alpha_test(const PatchSet& scene, std::int32_t i, double u, double v);

/// Whether something may be cut out of a patch, and it is no mere point.
inline bool has_alpha_mask(const PatchSet& scene, const Patch& patch) {
  return scene.primitives[patch.primitive].mask >= 0 && patch.area > 0;
}

/// A point of the unit square of a patch that has cut-outs where it is there: `at`, or, if that is in a hole, the first
/// of some others at random that is not. So what is uniform over the square becomes uniform over what is there. Where
/// that is next to nothing, holes count too.
Vec2f covered_point(const PatchSet& scene, const Patch& patch, const PatchSampler& sampler, Vec2f at,
                    std::uint64_t random);

}  // namespace patchlight

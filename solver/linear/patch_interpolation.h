#pragma once
#include "pipeline/optics/sampling/patch_lookup.h"
#include "solver/linear/linear_system.h"

namespace patchlight {

/// A field of patches' means [n] at (u,v) of a patch's primitive: bilinear between the middles of the patches about it,
/// on a sphere all around; beyond the outermost middles, as there.
Spectrum interpolate(const PatchSet& scene, const PatchLookup& lookup, std::int32_t patch, float u, float v,
                     const std::vector<Color>& field);

}  // namespace patchlight

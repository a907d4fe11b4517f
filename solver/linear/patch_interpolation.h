#pragma once
#include "pipeline/optics/sampling/patch_lookup.h"
#include "solver/linear/linear_system.h"

namespace patchlight {

/// Interpolates a field of patch means [n] at (u,v) of a patch's primitive: bilinear between patch centres, periodic in
/// u on a sphere, constant beyond the outermost centres, and on the patch where other surfaces stand between them.
Spectrum interpolate(const PatchSet& scene, const PatchLookup& lookup, std::int32_t patch, float u, float v,
                     const std::vector<Color>& field);

}  // namespace patchlight

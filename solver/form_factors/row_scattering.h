#pragma once
#include "pipeline/model/patch_set.h"
#include "solver/linear/scattering.h"

namespace patchlight {

/// How rows see what the diffuse part of a patch sends out, over the irradiance: `part` of the light below its coat.
/// Rays of rows that go on over coats and glass by chance reach the diffuse part of others only, which counts for all;
/// else coats absorb what they reflect. `coats`: whether rows go on over them.
Spectrum seen_by_rows(const PatchSet& scene, const Patch& patch, const Color& part, bool coats);

/// What patches scatter towards rays of rows that reach their diffuse parts. Shape: [patches].
Scattering row_scattering(const PatchSet& scene, bool coats);

}  // namespace patchlight

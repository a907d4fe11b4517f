#pragma once
#include <vector>

#include "importers/mesh/surface.h"
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Patch area, m2, for the primitives whose material has none of its own: the job's, or else an 8,000th of all area,
/// more where that would pass the limit. `materials` by Primitive::material. Throws: Error (over_limit), naming the
/// limit and what would fit, for more than import.max_patches.
double choose_patch_area(const std::vector<Primitive>& primitives, const std::vector<SurfaceMaterial>& materials,
                         const ImportConfig& config);

/// The patches of all primitives, in their order. `materials` by Primitive::material.
std::vector<Patch> build_patches(const std::vector<Primitive>& primitives,
                                 const std::vector<SurfaceMaterial>& materials, double patch_area);

}  // namespace patchlight

#pragma once
#include <vector>

#include "importers/mesh/surface.h"
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Patch area, m2, of primitives whose material sets none: import.patch_area, or by default 1/8000 of the total area,
/// more if that would exceed import.max_patches. `materials` by Primitive::material.
/// Throws: Error (over_limit) if import.patch_area gives too many patches; the message suggests an area that fits.
double choose_patch_area(const std::vector<Primitive>& primitives, const std::vector<SurfaceMaterial>& materials,
                         const ImportConfig& config);

/// The patches of all primitives, in the primitives' order. `materials` by Primitive::material.
std::vector<Patch> build_patches(const std::vector<Primitive>& primitives,
                                 const std::vector<SurfaceMaterial>& materials, double patch_area);

}  // namespace patchlight

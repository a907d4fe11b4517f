#pragma once
#include <vector>

#include "importers/mesh/surface.h"
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

constexpr double kDefaultPatches = 8000.0;  ///< Of a scale, with an import.accuracy of 1.

/// For each primitive the area, m2, of the surfaces that are not much larger than it: of the scene as far as it is of
/// the primitive's scale. A surface counts in full up to 16 times the primitive's extent, beyond that by the fourth
/// power of what it is larger. A facet of a body of many has the extent of the body, as far as it is about that of its
/// facets together. A quad that is most of its scale counts as up to eight times as much, since it sends no light to
/// itself.
std::vector<double> areas_of_scale(const std::vector<Primitive>& primitives);

/// Target areas of the patches of each primitive, m2: of its material, else import.patch_area, else
/// 1/(8000 import.accuracy) of areas_of_scale(), larger if that would exceed import.max_patches. So a room has the
/// patches that it has alone, also in a landscape, and each range of 16 times in extent gets about 8000 at most.
/// `materials` by Primitive::material.
/// Throws: Error (over_limit) if import.patch_area gives too many patches; the message suggests an area that fits.
std::vector<double> choose_patch_areas(const std::vector<Primitive>& primitives,
                                       const std::vector<SurfaceMaterial>& materials, const ImportConfig& config);

}  // namespace patchlight

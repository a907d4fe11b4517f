#pragma once
#include <cstdint>
#include <span>

#include "pipeline/model/display_mesh.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/patch_lookup.h"

namespace patchlight {

/// Gives the smooth vertices of `close` facets, patches of curved meshes that stand near to other surfaces, irradiance
/// of their own: the mean of the facets about a vertex would blur what stands beside it into its dark foot. Adds them
/// and all facets about them to `mesh`. Vertices that are covered take what the facet's others have.
void add_display_facets(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup,
                        std::span<const std::int32_t> near_patches, DisplayMesh& mesh);

}  // namespace patchlight

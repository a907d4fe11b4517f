#pragma once
#include <cstdint>
#include <span>

#include "pipeline/model/display_mesh.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/patch_lookup.h"

namespace patchlight {

/// Adds irradiance at the corners of facets to `mesh`: of all clusters, and of `near_patches`, patches of curved meshes
/// near other surfaces, with all facets around them, since the mean of the facets around a corner would blur the dark
/// contact. Corners that are enclosed in other bodies take that of another corner of their facet. Adds the number of
/// rays to `cast`.
void add_display_facets(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup,
                        std::span<const std::int32_t> near_patches, DisplayMesh& mesh, std::int64_t& cast);

}  // namespace patchlight

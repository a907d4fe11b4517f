#pragma once
#include <cstdint>

#include "pipeline/model/display_mesh.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/patch_lookup.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Refines patches into quadtrees where they are large relative to the harmonic mean distance to other surfaces (Ward,
/// Rubinstein and Clear 1988), or where other surfaces stand on them. Facets of curved meshes are not divided.
///
/// The result does not depend on the number of threads. Adds the number of rays to `cast`. Throws: Error (interrupted).
DisplayMesh build_display_mesh(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup,
                               std::uint64_t seed, std::int64_t& cast);

}  // namespace patchlight

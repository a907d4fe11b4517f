#pragma once
#include <cstdint>

#include "pipeline/model/display_mesh.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/sampling/patch_lookup.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Cuts patches into quadtrees where they are large for how near other surfaces are: by the harmonic mean of the
/// distances that a few rays go (Ward, Rubinstein and Clear 1988), and where something stands on them. Facets of curved
/// meshes stay whole.
///
/// The same for any number of threads. Adds the number of rays to `cast`. Throws: Error (interrupted).
DisplayMesh build_display_mesh(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup,
                               std::uint64_t seed, std::int64_t& cast);

}  // namespace patchlight

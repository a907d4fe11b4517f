#pragma once
#include "pipeline/model/patch_set.h"
#include "pipeline/model/transport.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Weighted form factors from all patches to the cells of the environment, by `rays` rays each, without specular
/// reflection: for rows that are not found by rays.
/// The result does not depend on the number of threads. Adds the number of rays to `cast`. Throws: Error (interrupted).
TransportRows sky_rows(const PatchSet& scene, const RayScene& ray_scene, int rays, std::uint64_t seed,
                       std::int64_t& cast, Progress& progress);

}  // namespace patchlight

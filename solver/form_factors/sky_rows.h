#pragma once
#include "pipeline/model/patch_set.h"
#include "pipeline/model/transport.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// What all patches see of the environment, by `rays` each, with weights: for rows that have none by rays. Not by way
/// of mirrors.
/// Adds the number of rays to `cast`. The same for any number of threads. Throws: Error (interrupted).
TransportRows sky_rows(const PatchSet& scene, const RayScene& ray_scene, int rays, std::uint64_t seed,
                       std::int64_t& cast, Progress& progress);

}  // namespace patchlight

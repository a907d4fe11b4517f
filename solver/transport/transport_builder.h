#pragma once
#include "pipeline/job/job.h"
#include "pipeline/job/shard.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/model/transport.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Completes `transport` for the scene, the settings and at least `rays` rays a row: casts rows unless it has them, and
/// samples form factors to every explicitly sampled emitter it lacks, with photons if rows are by rays and the scene
/// has metals. Removes other emitters. Returns the number of rays cast, 0 if nothing was missing. Throws: Error
/// (interrupted); (unavailable) without OpenGL for hemicubes.
std::int64_t complete_transport(const PatchSet& scene, const SolveConfig& config, int rays, Transport& transport,
                                Progress& progress);

/// Casts the rows of a shard's patches. Returns the number of rays. Throws: Error (interrupted).
std::int64_t cast_rows(const PatchSet& scene, const RayScene& ray_scene, const SolveConfig& config, int rays,
                       TransportRows& rows, Progress& progress, Shard shard = {});

}  // namespace patchlight

#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/model/shard.h"
#include "pipeline/model/transport.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Brings `transport` up to the scene, the settings and at least `rays` a row: rows where it has others or fewer, and
/// form factors to every emitter sampled apart that it does not hold yet, with photons of theirs where rows follow
/// mirrors; those of others go. Returns the number of
/// rays cast, 0 if nothing was missing. Throws: Error (interrupted); (unavailable) without OpenGL for hemicubes.
std::int64_t complete_transport(const PatchSet& scene, const SolveConfig& config, int rays, Transport& transport,
                                Progress& progress);

/// Casts the rows of a shard's patches. Returns the number of rays. Throws: Error (interrupted).
std::int64_t cast_rows(const PatchSet& scene, const RayScene& ray_scene, const SolveConfig& config, int rays,
                       TransportRows& to, Progress& progress, Shard shard = {});

}  // namespace patchlight

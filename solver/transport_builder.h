#pragma once
#include "pipeline/files/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/model/transport.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Brings `transport` up to the scene and the settings: rows where its key is another, and form factors to every
/// emitter sampled apart that it does not hold yet; those of others go. Returns the number of rays cast, 0 if nothing
/// was missing.
/// Throws: Error (interrupted); (unavailable) without OpenGL for hemicubes.
std::int64_t complete_transport(const PatchSet& scene, const SolveConfig& config, Transport& transport,
                                Progress& progress);

}  // namespace patchlight

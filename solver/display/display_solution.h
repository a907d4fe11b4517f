#pragma once
#include "pipeline/job/job.h"
#include "pipeline/job/shard.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/model/transport.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Adds the display solution to `energy`: a final gather at the vertices of a DisplayMesh, where irradiance varies too
/// much within patches. Its difference from the patches adds to the stated errors. It gathers from patches and, where
/// they are divided, from the mesh's leaves, with the leaves' direct light and the irradiance of an earlier gather at
/// their corners, which improves creases and contacts.
///
/// Rows that `transport` lacks are cast, added to it, and counted in energy.rays. The result does not depend on the
/// number of threads. Throws: Error (interrupted), (bad_data).
void add_display_solution(const PatchSet& scene, const SolveConfig& config, Transport& transport, EnergyField& energy,
                          Progress& progress);

/// Rays of a display mesh vertex where patches have `rays` rays.
int display_rays(int rays);

/// Builds the display mesh, adding its number of rays to `mesh_rays`, and casts the rows of a shard's vertices with
/// `rays` rays each. Returns the number of the rows' rays. Throws: Error (interrupted).
std::int64_t cast_display(const PatchSet& scene, const RayScene& ray_scene, const SolveConfig& config, int rays,
                          Transport::Display& display, std::int64_t& mesh_rays, Progress& progress, Shard shard = {});

}  // namespace patchlight

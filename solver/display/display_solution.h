#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/model/shard.h"
#include "pipeline/model/transport.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Adds the display solution to `energy`: where patches are too large for how irradiance varies, a final gather at the
/// vertices of a DisplayMesh. It sees patches and, in their place, the mesh's leaves: with their own direct light, and
/// with what a first gather brought their corners, which is what mends creases and contacts.
///
/// What needs rays goes into `transport`, and into energy.rays how many, unless it is there already.
/// The same for any number of threads. Throws: Error (interrupted).
void add_display_solution(const PatchSet& scene, const SolveConfig& config, Transport& transport, EnergyField& energy,
                          Progress& progress);

/// Rays of a vertex of the display mesh, where a patch has `rays`.
int display_rays(int rays);

/// Builds the display mesh, which adds to `for_mesh` the number of rays, and casts the rows of a shard's vertices with
/// `rays` each. Returns the number of these. Throws: Error (interrupted).
std::int64_t cast_display(const PatchSet& scene, const RayScene& ray_scene, const SolveConfig& config, int rays,
                          Transport::Display& display, std::int64_t& for_mesh, Progress& progress, Shard shard = {});

}  // namespace patchlight

#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Writes the scene's lights without extent, nothing where there are none: a row of `/lights/name`, `kind`,
/// `light_group`, `strength` and `shape` (position, direction, inner and outer angle) for each.
void write_light_datasets(H5Writer& writer, const PatchSet& scene);

/// Reads that into the scene, whose light groups are there already. Throws: Error (bad_data), also for what is out of
/// range.
void read_light_datasets(const H5Reader& reader, PatchSet& scene);

}  // namespace patchlight

#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Writes the scene's point, spot and sun lights, if it has any. One row per light of `/lights/name`, `kind`,
/// `light_group`, `strength` and `shape` (position, direction, inner and outer angle).
void write_light_datasets(H5Writer& writer, const PatchSet& scene);

/// Reads the lights into the scene, whose light groups must be read before. Throws: Error (bad_data), also for values
/// out of range.
void read_light_datasets(const H5Reader& reader, PatchSet& scene);

}  // namespace patchlight

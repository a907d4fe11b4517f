#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Writes the scene's environment, nothing without one: `/environment/rows` and `cells`, `light_group`, and for frames
/// `size` (width, height), `texels` and `view` (turn, clip).
void write_environment_datasets(H5Writer& writer, const PatchSet& scene);

/// Reads that into the scene, whose light groups are there already. Throws: Error (bad_data), also for what is out of
/// range.
void read_environment_datasets(const H5Reader& reader, PatchSet& scene);

}  // namespace patchlight

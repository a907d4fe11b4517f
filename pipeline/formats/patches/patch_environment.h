#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Writes the scene's environment, if it has one: `/environment/rows`, `cells` and `light_group`, and for frames
/// `size` (width, height), `texels` and `view` (turn, clip).
void write_environment_datasets(H5Writer& writer, const PatchSet& scene);

/// Reads the environment into the scene, whose light groups must be read before. Throws: Error (bad_data), also for
/// values out of range.
void read_environment_datasets(const H5Reader& reader, PatchSet& scene);

}  // namespace patchlight

#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Writes how the scene's cameras move, nothing where none does: one row of `/motions/camera`, `kind`, `interpolation`
/// and `keys` for each factor, and behind each other their `/motions/time` and `/motions/value`.
void write_motion_datasets(H5Writer& writer, const PatchSet& scene);

/// Reads that into the scene's cameras, which are there already. Throws: Error (bad_data).
void read_motion_datasets(const H5Reader& reader, PatchSet& scene);

}  // namespace patchlight

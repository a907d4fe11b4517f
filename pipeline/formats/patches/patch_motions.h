#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Writes the motions of the scene's cameras, if there are any. One row per factor of `/motions/camera`, `kind`,
/// `interpolation` and `keys`; `/motions/time` and `/motions/value` hold the keyframes of all factors in this order.
void write_motion_datasets(H5Writer& writer, const PatchSet& scene);

/// Reads the motions into the scene's cameras, which must be read before. Throws: Error (bad_data).
void read_motion_datasets(const H5Reader& reader, PatchSet& scene);

}  // namespace patchlight

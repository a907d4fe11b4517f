#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Writes the scene's cameras and, if there are any, shifts, clip depths and lenses of cameras and their motions. One
/// row per factor of `/motions/camera`, `kind`, `interpolation` and `keys`; `/motions/time` and `/motions/value` hold
/// the keyframes of all factors in this order.
void write_camera_datasets(H5Writer& writer, const PatchSet& scene);

/// Throws: Error (bad_data).
void read_camera_datasets(const H5Reader& reader, PatchSet& scene);

}  // namespace patchlight

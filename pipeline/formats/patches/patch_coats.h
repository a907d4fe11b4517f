#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Writes the coats of materials and what those of patches let through, if there are any.
void write_coat_datasets(H5Writer& writer, const PatchSet& scene);

/// Reads them into a scene that has its materials and patches.
void read_coat_datasets(const H5Reader& reader, PatchSet& scene);

/// Whether a coat's values are in their ranges.
bool is_valid(const Coat& coat);

}  // namespace patchlight

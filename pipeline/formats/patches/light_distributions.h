#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Writes the distributions of lights, and which light has which, if there are any: `/distributions/...`,
/// `/lights/distribution`, `/lights/across`.
void write_distribution_datasets(H5Writer& writer, const PatchSet& scene);

/// Expects the lights to be read. Throws: Error (bad_data) for values out of range.
void read_distribution_datasets(const H5Reader& reader, PatchSet& scene);

}  // namespace patchlight

#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Writes the coats of materials and what those of patches let through, if there are any.
void write_coat_datasets(H5Writer& writer, const PatchSet& scene);

/// Reads them into a scene that has its materials and patches.
void read_coat_datasets(const H5Reader& reader, PatchSet& scene);

/// Writes what materials let pass, if any does.
void write_transmissions(H5Writer& writer, const std::vector<Material>& materials);
void read_transmissions(const H5Reader& reader, std::vector<Material>& materials);

/// Writes the translucences of materials, if there are any.
void write_translucences(H5Writer& writer, const std::vector<Material>& materials);
void read_translucences(const H5Reader& reader, std::vector<Material>& materials);

/// Whether all values are in their ranges.
bool is_valid(const Material& material);

}  // namespace patchlight

#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

// Datasets of patches.h5 that exist only in scenes with shaders:
// /shaders/name [s], /shaders/reflectance and /shaders/emission [3 s] (expressions, empty where not set),
// /primitives/shader [m] (-1: none), and /primitives/texcoord [m,4,2] if texture coordinates are used.

void write_shader_datasets(H5Writer& writer, const PatchSet& scene);

/// The scene's primitives must be read before. Throws: Error (bad_data).
void read_shader_datasets(const H5Reader& reader, PatchSet& scene);

}  // namespace patchlight

#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

// The part of patches.h5 that stands there only in a scene with shaders:
// /shaders/name [s], /shaders/reflectance and /shaders/emission [3 s] (expressions, empty where not set),
// /primitives/shader [m] (-1: none), and /primitives/texcoord [m,4,2] where a mesh's TEXCOORD_0 is needed.

void write_shader_datasets(H5Writer& writer, const PatchSet& scene);

/// Expects `scene` to hold its primitives already. Throws: Error (bad_data).
void read_shader_datasets(const H5Reader& reader, PatchSet& scene);

}  // namespace patchlight

#pragma once
#include <cstdint>

#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/display_mesh.h"

namespace patchlight {

/// Puts a display mesh into the group `/display/mesh` of a file.
void write_display_mesh(H5Writer& writer, const DisplayMesh& mesh);

/// `patches`: how many the scene has; -1: any number. Throws: Error (bad_data) for anything that is not a mesh of it.
DisplayMesh read_display_mesh(const H5Reader& reader, std::int64_t patches);

}  // namespace patchlight

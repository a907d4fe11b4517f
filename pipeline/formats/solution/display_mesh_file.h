#pragma once
#include <cstdint>

#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/display_mesh.h"

namespace patchlight {

/// Writes a display mesh to the group `/display/mesh` of a file.
void write_display_mesh(H5Writer& writer, const DisplayMesh& mesh);

/// Reads and checks a display mesh. `patches`: number of the scene's patches; -1: any. Throws: Error (bad_data).
DisplayMesh read_display_mesh(const H5Reader& reader, std::int64_t patches);

}  // namespace patchlight

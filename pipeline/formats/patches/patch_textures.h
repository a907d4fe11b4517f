#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Textures, masks and vertices' colours, which primitives have them, and texture coordinates; a scene without them has
/// no such datasets.
void write_texture_datasets(H5Writer& writer, const PatchSet& scene);

/// The datasets that say what masks cut out and how metals vary, both of which transport depends on, by the beginnings
/// of their names; none for a scene without.
std::vector<std::string> transport_textures(const PatchSet& scene);

/// Expects the patches, primitives and materials of `scene` to be there. Throws: Error (bad_data).
void read_texture_datasets(const H5Reader& reader, PatchSet& scene);

}  // namespace patchlight

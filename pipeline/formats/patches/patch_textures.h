#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Writes textures, masks, vertex colours, normals and texture coordinates, and the primitives' indices of these.
/// Datasets are omitted if the scene has none.
void write_texture_datasets(H5Writer& writer, const PatchSet& scene);

/// Name prefixes of the datasets of alpha masks and metallic-roughness textures, on which transport depends; empty for
/// a scene without these.
std::vector<std::string> transport_textures(const PatchSet& scene);

/// Key of every primitive's specular material and alpha mask, on which transport depends; independent of the order of
/// materials.
std::string metallic_roughness_key(const PatchSet& scene);

/// The scene's patches, primitives and materials must be read before. Throws: Error (bad_data).
void read_texture_datasets(const H5Reader& reader, PatchSet& scene);

}  // namespace patchlight

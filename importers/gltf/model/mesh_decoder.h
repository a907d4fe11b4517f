#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "importers/gltf/check/compression.h"
#include "importers/gltf/file/uri.h"

namespace patchlight {

/// One attribute of a Draco mesh, decoded to its accessor's type.
struct DracoAttribute {
  std::string name;
  int id = 0;              ///< Unique id in the Draco data.
  int component_type = 0;  ///< glTF's componentType.
  int components = 0;
  double rounding = 0.0;  ///< Output: largest quantization error.
  Bytes bytes;            ///< Output: tightly compressed elements.
};

/// Input and output of decode_draco.
struct DracoMesh {
  std::size_t triangles = 0;  ///< Expected number.
  std::size_t vertices = 0;   ///< Output.
  std::vector<DracoAttribute> attributes;
  Bytes indices;  ///< Output: 32-bit, 3 per triangle.
};

/// Decodes a bufferView compressed by EXT_meshopt_compression or KHR_meshopt_compression. `place` names it in errors.
/// Throws: Error (bad_data) for damaged bytes.
Bytes decompress_meshopt(const MeshoptView& view, std::span<const unsigned char> compressed, const std::string& place);

/// Decodes a mesh's attributes and indices compressed by Draco. `place` names the mesh in errors.
/// Throws: Error (bad_data) for damaged bytes, other counts, or missing attributes.
void decompress_draco(std::span<const unsigned char> compressed, const std::string& place, DracoMesh& mesh);

/// The implementations in the plugin, loaded at the first call. decode_meshopt returns false for damaged bytes.
extern "C" bool decode_meshopt(const MeshoptView& view, std::span<const unsigned char> compressed, Bytes& elements);
extern "C" void decode_draco(std::span<const unsigned char> compressed, const std::string& place, DracoMesh& mesh);

}  // namespace patchlight

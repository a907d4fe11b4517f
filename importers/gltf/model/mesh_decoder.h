#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "importers/gltf/check/packing.h"
#include "importers/gltf/file/uri.h"

namespace patchlight {

/// One attribute of a Draco mesh, as the accessor that it is for wants it.
struct DracoAttribute {
  std::string name;
  int id = 0;              ///< In the packed bytes.
  int component_type = 0;  ///< glTF's number.
  int components = 0;
  double rounding = 0.0;  ///< How far off quantized numbers may be; filled in by the decoder, as the next.
  Bytes bytes;            ///< Elements without gaps.
};

/// A Draco mesh that was, or is to be, unpacked.
struct DracoMesh {
  std::size_t triangles = 0;  ///< As the file states; what the packed bytes state must be the same.
  std::size_t vertices = 0;
  std::vector<DracoAttribute> attributes;
  Bytes indices;  ///< 32-bit, three each triangle.
};

/// Unpacks elements by EXT_meshopt_compression. `place` names the bufferView for errors.
/// Throws: Error (bad_data) for packed bytes that are damaged.
Bytes unpack_meshopt(const MeshoptView& view, std::span<const unsigned char> packed, const std::string& place);

/// Unpacks a mesh's attributes and indices by Draco. `place` names the mesh for errors.
/// Throws: Error (bad_data) for packed bytes that are damaged or do not hold what the mesh asks for.
void unpack_draco(std::span<const unsigned char> packed, const std::string& place, DracoMesh& mesh);

/// What these load when they are first called.
extern "C" bool decode_meshopt(const MeshoptView& view, std::span<const unsigned char> packed, Bytes& elements);
extern "C" void decode_draco(std::span<const unsigned char> packed, const std::string& place, DracoMesh& mesh);

}  // namespace patchlight

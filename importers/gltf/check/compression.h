#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace patchlight {

struct GltfLists;

/// A bufferView compressed by EXT_meshopt_compression or KHR_meshopt_compression.
struct MeshoptView {
  enum class Mode { attributes, triangles, indices };
  enum class Filter { none, octahedral, quaternion, exponential, color };

  int view = 0;  ///< Index of the bufferView.
  int buffer = 0;
  std::size_t offset = 0, size = 0;  ///< Of the compressed bytes in `buffer`.
  std::size_t count = 0;             ///< Elements.
  std::size_t stride = 0;            ///< Bytes of an element.
  Mode mode = Mode::attributes;
  Filter filter = Filter::none;
  bool khr = false;  ///< Of KHR_meshopt_compression.

  /// Largest compression ratio that is accepted. Vertices of the EXT reach 64, indices 12; constant ones of the KHR
  /// 1024.
  std::size_t max_ratio() const { return khr ? 1024 : 128; }
};

/// A mesh primitive compressed by KHR_draco_mesh_compression.
struct DracoPrimitive {
  int mesh = 0;
  int primitive = 0;
  int view = 0;     ///< The bufferView of the compressed bytes.
  int indices = 0;  ///< Accessor of the indices. It has no bufferView, which tinygltf would refuse.
  std::map<std::string, int> attributes;  ///< Draco's ids by attribute name.
};

/// Check the compressed parts of a file: ranges, strides and plausible sizes. A primitive whose accessors all have a
/// bufferView needs no decompression and is omitted. Throw: Error (bad_data) naming the element.
std::vector<MeshoptView> checked_meshopt_views(const GltfLists& gltf);
std::vector<DracoPrimitive> checked_draco_primitives(const GltfLists& gltf);

}  // namespace patchlight

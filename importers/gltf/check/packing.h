#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace patchlight {

struct GltfLists;

/// Bytes that EXT_meshopt_compression makes of one; vertices reach 64, indices 12.
constexpr std::size_t kMostMeshoptGain = 128;

/// A bufferView that EXT_meshopt_compression packs.
struct MeshoptView {
  enum class Mode { attributes, triangles, indices };
  enum class Filter { none, octahedral, quaternion, exponential };

  int view = 0;  ///< The bufferView that it stands for.
  int buffer = 0;
  std::size_t offset = 0, size = 0;  ///< Of the packed bytes in the buffer.
  std::size_t count = 0;             ///< Elements.
  std::size_t stride = 0;            ///< Bytes of one.
  Mode mode = Mode::attributes;
  Filter filter = Filter::none;
};

/// A mesh primitive that KHR_draco_mesh_compression packs.
struct DracoPrimitive {
  int mesh = 0;
  int primitive = 0;
  int view = 0;                           ///< The bufferView of the packed bytes.
  int indices = 0;                        ///< The accessor that they are to fill; tinygltf would refuse it.
  std::map<std::string, int> attributes;  ///< The attributes' ids in there.
};

/// The parts of a file that are to be unpacked, checked: within their buffers, and of sizes that packed bytes can have.
/// A primitive whose accessors all have bytes of their own needs no Draco, and is left out.
/// Throws: Error (bad_data) naming the place.
std::vector<MeshoptView> checked_meshopt_views(const GltfLists& gltf);
std::vector<DracoPrimitive> checked_draco_primitives(const GltfLists& gltf);

}  // namespace patchlight

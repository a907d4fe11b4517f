#pragma once
// Internal to the glTF files of this folder: brings tinygltf along.
#include <tiny_gltf.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "importers/gltf/check/gltf_check.h"
#include "importers/gltf/file/gltf_file.h"
#include "pipeline/model/math.h"

namespace patchlight {

/// Triangles of one mesh that share a material.
struct MeshPart {
  int material = -1;
  std::vector<int> primitives;  ///< Of the glTF mesh; those with triangles only.
  std::int64_t triangles = 0;
  bool has_colors = false;  ///< Of vertices, in any of them;
  bool has_alphas = false;  ///< with alpha.
};

/// A checked and parsed glTF file with its buffers.
struct GltfModel {
  GltfFile file;
  CheckedGltf checked;
  tinygltf::Model gltf;  ///< Without buffers and images.
  std::vector<std::shared_ptr<const Bytes>> owned;
  std::vector<std::span<const unsigned char>> buffers;
  std::vector<std::vector<MeshPart>> mesh_parts;  ///< By mesh.
  std::map<int, double> roundings;  ///< By accessor: how far off the numbers may be that Draco has quantized.
};

/// Checks and parses the file and loads its buffers; `wanted` as for check_gltf.
/// Throws: Error (missing_input, bad_data, over_limit, io_error).
GltfModel load_gltf_model(GltfFile file, const GltfWanted& wanted);

/// The bytes of a bufferView, which check_gltf has shown to lie within what its buffer states.
/// Throws: Error (bad_data) if the buffer is a placeholder.
std::span<const unsigned char> view_bytes(const GltfModel& model, int view);

/// The encoded bytes of an image; `owner` keeps them alive.
/// Throws: Error as read_uri does.
std::span<const unsigned char> image_bytes(GltfModel& model, int image, std::shared_ptr<const Bytes>& owner);

}  // namespace patchlight

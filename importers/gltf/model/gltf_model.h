#pragma once
// Internal to importers/gltf: includes tinygltf.
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

/// Mesh primitives of one mesh that share a material.
struct MeshPart {
  int material = -1;
  std::vector<int> primitives;  ///< Indices in the glTF mesh; only primitives with triangles.
  std::int64_t triangles = 0;
  bool has_colors = false;  ///< A primitive has vertex colours.
  bool has_alphas = false;  ///< A primitive has vertex alpha.
};

/// A checked and parsed glTF file with its buffers.
struct GltfModel {
  GltfFile file;
  CheckedGltf checked;
  tinygltf::Model gltf;                             ///< Without buffers and images.
  std::vector<std::shared_ptr<const Bytes>> owned;  ///< Keeps the bytes of `buffers` alive.
  std::vector<std::span<const unsigned char>> buffers;
  std::vector<std::vector<MeshPart>> mesh_parts;  ///< By mesh.
  std::map<int, double> roundings;                ///< By accessor: largest error of components that Draco quantized.
};

/// Checks and parses the file and loads its buffers; `options` as for check_gltf.
/// Throws: Error (missing_input, bad_data, over_limit, io_error).
GltfModel load_gltf_model(GltfFile file, const GltfReadOptions& options);

/// The bytes of a bufferView. Expects a checked one.
/// Throws: Error (bad_data) if the buffer is a placeholder.
std::span<const unsigned char> view_bytes(const GltfModel& model, int view);

/// The encoded bytes of an image; empty without data. `owner` keeps them alive.
/// Throws: like read_uri.
std::span<const unsigned char> image_bytes(GltfModel& model, int image, std::shared_ptr<const Bytes>& owner);

}  // namespace patchlight

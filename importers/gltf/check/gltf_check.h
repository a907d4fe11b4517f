#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "importers/gltf/check/compression.h"
#include "importers/gltf/check/pose_check.h"
#include "pipeline/model/light.h"

namespace patchlight {

/// Source of the bytes of a buffer or an image.
struct GltfData {
  std::string name;
  std::string uri;       ///< Empty: the binary chunk (buffer 0), or `buffer_view`.
  int buffer_view = -1;  ///< Of an image; -1: none.
  std::size_t size = 0;  ///< byteLength of a buffer.
};

/// Optional parts of a glTF file to read.
struct GltfReadOptions {
  bool texcoords = false;   ///< TEXCOORD_0, even if no texture uses it.
  bool animations = false;  ///< Animations of all nodes, not only of cameras.
};

/// A node's instances (EXT_mesh_gpu_instancing).
struct GltfInstances {
  std::map<std::string, int> attributes;  ///< Accessors of TRANSLATION, ROTATION and SCALE, where present.
  std::size_t count = 0;
};

/// Custom properties (extras) of a light or of its node.
struct GltfLightExtras {
  std::optional<double> radius;  ///< Of a point light or spot, m.
  std::optional<double> angle;   ///< Apparent diameter of a sun, degrees.
  std::string ies;               ///< URI of the photometric file of a point light or spot; empty: none.
};

/// A light of KHR_lights_punctual.
struct GltfLight {
  Light light;  ///< Position and direction unset; strength in the file's unit.
  Color color{1.0f};
  std::string name;
  std::string light_group;  ///< From its extras; empty: none.
  GltfLightExtras extras;
  bool known = true;  ///< Its type is supported.
};

/// A node's light with a profile of EXT_lights_ies.
struct GltfProfileLight {
  std::size_t profile = 0;  ///< Index into CheckedGltf::light_profiles.
  double multiplier = 1.0;
  Color color{1.0f};
};

/// What a node's extras say about the lens of its camera; in the units of Camera.
struct GltfLens {
  std::optional<Vec2d> shift{};
  std::optional<double> aspect{}, aperture{}, focus{};
};

/// A glTF file that is safe to parse.
struct CheckedGltf {
  std::string json;               ///< Only the parts that the importer reads, for tinygltf; without buffers and images.
  std::vector<GltfData> buffers;  ///< Not loaded by tinygltf, which would open any URI.
  std::vector<GltfData> images;
  std::vector<MeshoptView> meshopt_views;
  std::vector<DracoPrimitive> draco_primitives;
  std::vector<NodeChannel> node_channels;
  std::map<int, GltfInstances> instances;  ///< By node.
  std::vector<int> parents;                ///< By node; -1: root.
  std::vector<char> hidden;                ///< By node: hidden by itself, and everything below it.
  std::vector<NodeChannel> camera_channels;
  std::map<int, GltfLens> lenses;  ///< By node with a camera.
  std::vector<GltfLight> lights;
  std::map<int, int> node_lights;  ///< Indices into `lights`, by node.
  /// Of nodes with a light, and of their parents; of other nodes with a mesh, their photometric file.
  std::map<int, GltfLightExtras> node_light_extras;
  std::vector<GltfData> light_profiles;            ///< Of EXT_lights_ies.
  std::map<int, GltfProfileLight> profile_lights;  ///< By node.
  std::vector<std::string> ignored;                ///< Warnings of contents that are not imported.
};

/// Checks every part of a glTF file's JSON that the importer and tinygltf read: version, required extensions, types,
/// indices, ranges of accessors and bufferViews, node trees, and animations. Only texture coordinate sets that are used
/// are checked and kept. Throws: Error (bad_data) naming the element.
CheckedGltf check_gltf(std::string_view json, const std::string& file, const GltfReadOptions& options = {});

}  // namespace patchlight

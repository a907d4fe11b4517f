#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "importers/gltf/check/packing.h"
#include "importers/gltf/check/pose_check.h"
#include "pipeline/model/light.h"

namespace patchlight {

/// Where the bytes of a buffer or an image come from.
struct GltfData {
  std::string name;
  std::string uri;       ///< Empty: the binary chunk (buffer 0), or `buffer_view`.
  int buffer_view = -1;  ///< Of an image.
  std::size_t size = 0;  ///< Stated length of a buffer, bytes.
};

/// What will be read of a glTF file beyond what always is.
struct GltfWanted {
  bool texcoords = false;   ///< The first set, even if no texture lies by it.
  bool animations = false;  ///< What moves nodes.
};

/// A node's instances: accessors of TRANSLATION, ROTATION and SCALE.
struct GltfInstances {
  std::map<std::string, int> attributes;
  std::size_t count = 0;
};

/// A light as KHR_lights_punctual has it.
struct GltfLight {
  Light light;  ///< Without a place; its strength in the file's unit.
  std::string name;
  std::string light_group;  ///< As its extras name it.
  bool known = true;        ///< Of a type that is.
};

/// A glTF file that is safe to parse.
struct CheckedGltf {
  std::string json;               ///< What the importer reads of it, without buffers and images, for tinygltf.
  std::vector<GltfData> buffers;  ///< To be loaded apart from tinygltf, which would follow any URI.
  std::vector<GltfData> images;
  std::vector<MeshoptView> meshopt_views;
  std::vector<DracoPrimitive> draco_primitives;
  std::vector<NodeChannel> node_channels;
  std::map<int, GltfInstances> instances;  ///< By node, of those that have some.
  std::vector<int> parents;                ///< By node; -1: a root.
  std::vector<NodeChannel> camera_channels;
  std::vector<GltfLight> lights;
  std::map<int, int> node_lights;    ///< Indices into `lights`, by node, of those that have one.
  std::vector<std::string> ignored;  ///< What the scene holds beyond what is read, one warning each.
};

/// Checks all that the importer and tinygltf read of a glTF file's JSON: version, required extensions, types, indices,
/// that accessors lie within bufferViews and these within buffers, that nodes are trees, and what moves cameras.
/// Of texture coordinates the sets are checked, and kept, that textures lie by.
/// Throws: Error (bad_data) naming the place.
CheckedGltf check_gltf(std::string_view json, const std::string& file, const GltfWanted& wanted = {});

}  // namespace patchlight

#include "importers/gltf_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "importers/gltf_accessor_check.h"
#include "importers/gltf_lists.h"
#include "importers/gltf_mesh_check.h"
#include "importers/gltf_reduce.h"
#include "importers/gltf_tree_check.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr std::array kSupportedExtensions{
    "KHR_materials_emissive_strength", "KHR_materials_specular",     "KHR_materials_ior",      "KHR_materials_unlit",
    "KHR_mesh_quantization",           "KHR_draco_mesh_compression", "EXT_meshopt_compression"};

constexpr std::size_t kMostTexcoords = 1000;  // sets of them that a mesh may have

void check_asset(const GltfLists& gltf) {
  const GltfPlace place{gltf.file};
  const Json* asset = find_object(gltf.root, "asset", place);
  const std::string version = asset ? string_member(*asset, "version") : "";
  if (!version.starts_with("2.")) {
    refuse_gltf(version.empty() ? "no glTF version is stated" : fmt::format("glTF version {} is not 2", version), place,
                "asset.version");
  }
  if (const Json* required = find_array(gltf.root, "extensionsRequired", place)) {
    for (const Json& extension : *required) {
      if (!extension.is_string()) refuse_gltf("must hold names", place, "extensionsRequired");
      const std::string name = extension.get<std::string>();
      if (std::find(kSupportedExtensions.begin(), kSupportedExtensions.end(), name) == kSupportedExtensions.end()) {
        throw Error(ExitCode::bad_data, fmt::format("required extension {} is not supported", name), gltf.file,
                    "export the scene without it");
      }
    }
  }
}

std::vector<GltfData> checked_data(const GltfLists& gltf, const char* key) {
  std::vector<GltfData> result;
  gltf.each(key, [&](const Json& item, const GltfPlace& place) {
    check_string(item, "uri", place);
    GltfData data;
    data.name = fmt::format("{}[{}]", key, place.index);
    data.uri = string_member(item, "uri");
    data.buffer_view = index_member(item, "bufferView", gltf.count("bufferViews"), place);
    data.size = static_cast<std::size_t>(whole_number(item, "byteLength", 0, place));
    result.push_back(std::move(data));
  });
  return result;
}

void check_texture_info(const GltfLists& gltf, const Json& owner, const char* key, const GltfPlace& place) {
  const Json* info = find_object(owner, key, place);
  if (!info) return;
  if (index_member(*info, "index", gltf.count("textures"), place) < 0) refuse_gltf("has no index", place, key);
  index_member(*info, "texCoord", kMostTexcoords, place);
}

void check_materials(GltfLists& gltf) {
  gltf.each("materials", [&](const Json& material, const GltfPlace& place) {
    check_string(material, "name", place);
    check_numbers(material, "emissiveFactor", 3, place);
    check_texture_info(gltf, material, "emissiveTexture", place);
    const Json* sides = find_member(material, "doubleSided");
    if (sides && !sides->is_boolean()) refuse_gltf("must be true or false", place, "doubleSided");
    if (const Json* pbr = find_object(material, "pbrMetallicRoughness", place)) {
      check_numbers(*pbr, "baseColorFactor", 4, place);
      check_number(*pbr, "metallicFactor", place);
      check_number(*pbr, "roughnessFactor", place);
      check_texture_info(gltf, *pbr, "baseColorTexture", place);
      check_texture_info(gltf, *pbr, "metallicRoughnessTexture", place);
    }
    if (const Json* extensions = find_object(material, "extensions", place)) {
      const Json* emission = find_object(*extensions, "KHR_materials_emissive_strength", place);
      if (emission) check_number(*emission, "emissiveStrength", place);
      if (extensions->contains("KHR_materials_unlit")) gltf.ignored.insert("unlit materials are read as lit ones");
    }
  });
  gltf.each("textures", [&](const Json& texture, const GltfPlace& place) {
    index_member(texture, "source", gltf.count("images"), place);
    index_member(texture, "sampler", gltf.count("samplers"), place);
  });
  gltf.each("samplers", [&](const Json& sampler, const GltfPlace& place) {
    for (const char* key : {"magFilter", "wrapS", "wrapT"}) whole_number(sampler, key, 0, place);
  });
}

bool has_base_color_texture(const GltfLists& gltf) {
  const Json& materials = gltf.list("materials");
  return std::any_of(materials.begin(), materials.end(), [](const Json& material) {
    const Json* pbr = find_member(material, "pbrMetallicRoughness");
    return pbr && pbr->contains("baseColorTexture");
  });
}

void check_nodes(GltfLists& gltf) {
  std::vector<std::vector<int>> children(gltf.count("nodes"));
  gltf.each("nodes", [&](const Json& node, const GltfPlace& place) {
    check_string(node, "name", place);
    check_numbers(node, "matrix", 16, place);
    check_numbers(node, "translation", 3, place);
    check_numbers(node, "rotation", 4, place);
    check_numbers(node, "scale", 3, place);
    index_member(node, "mesh", gltf.count("meshes"), place);
    index_member(node, "camera", gltf.count("cameras"), place);
    if (node.contains("skin")) gltf.ignored.insert("skins are not read: meshes stand in their rest pose");
    if (const Json* list = find_array(node, "children", place)) {
      for (const Json& child : *list) {
        children[place.index].push_back(checked_index(child, "children", children.size(), place));
      }
    }
  });
  check_node_trees(gltf.list("nodes"), gltf.list("scenes"), children, gltf.file);
  index_member(gltf.root, "scene", gltf.count("scenes"), {gltf.file});
}

}  // namespace

CheckedGltf check_gltf(std::string_view json, const std::string& file, bool texcoords) {
  const Json root = parse_gltf_json(json, file);
  GltfLists gltf(root, file);
  check_asset(gltf);
  CheckedGltf result;
  result.buffers = checked_data(gltf, "buffers");
  result.images = checked_data(gltf, "images");
  check_buffer_views(gltf, result.buffers);
  check_accessors(gltf);
  check_materials(gltf);
  texcoords = texcoords || has_base_color_texture(gltf);
  check_meshes(gltf, texcoords ? std::set{0} : std::set<int>());
  result.meshopt_views = checked_meshopt_views(gltf);
  result.draco_primitives = checked_draco_primitives(gltf);
  check_nodes(gltf);
  if (gltf.count("animations") > 0) gltf.ignored.insert("animations are not read: nodes stand in their rest state");
  result.ignored.assign(gltf.ignored.begin(), gltf.ignored.end());
  result.json = reduced_gltf(root, texcoords).dump();
  return result;
}

}  // namespace patchlight

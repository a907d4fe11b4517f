#include "importers/gltf/check/gltf_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "importers/gltf/check/accessor_check.h"
#include "importers/gltf/check/camera_check.h"
#include "importers/gltf/check/deform_check.h"
#include "importers/gltf/check/gltf_lists.h"
#include "importers/gltf/check/light_check.h"
#include "importers/gltf/check/material_extensions.h"
#include "importers/gltf/check/mesh_check.h"
#include "importers/gltf/check/reduced_gltf.h"
#include "importers/gltf/check/specular_glossiness_check.h"
#include "importers/gltf/check/texture_check.h"
#include "importers/gltf/check/tree_check.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

/// Besides material_extensions().
constexpr std::array kSupportedExtensions{"KHR_materials_unlit",
                                          kSpecularGlossiness,
                                          "KHR_mesh_quantization",
                                          "KHR_draco_mesh_compression",
                                          "EXT_meshopt_compression",
                                          "KHR_meshopt_compression",
                                          "KHR_texture_transform",
                                          kWebp,
                                          kBasisu,
                                          "KHR_materials_variants",
                                          "EXT_mesh_gpu_instancing",
                                          "KHR_lights_punctual",
                                          "EXT_lights_ies",
                                          "KHR_node_visibility"};

bool is_supported(const std::string& extension) {
  return std::find(kSupportedExtensions.begin(), kSupportedExtensions.end(), extension) != kSupportedExtensions.end() ||
         std::ranges::any_of(material_extensions(), [&](const auto& known) { return known.name == extension; });
}

/// Refuses required extensions that are not supported, and warns of optional ones.
void check_extensions(GltfLists& gltf) {
  std::string unknown;
  for (const char* key : {"extensionsRequired", "extensionsUsed"}) {
    const Json* names = find_array(gltf.root, key, {gltf.file});
    for (std::size_t i = 0; names && i < names->size(); ++i) {
      if (!(*names)[i].is_string()) refuse_gltf("must hold names", {gltf.file}, key);
      const std::string name = (*names)[i].get<std::string>().substr(0, 100);
      if (is_supported(name)) continue;
      if (key == std::string_view("extensionsRequired")) {
        throw Error(ExitCode::bad_data, fmt::format("required extension {} is not supported", name), gltf.file,
                    "export the scene without this extension");
      }
      unknown += (unknown.empty() ? "" : ", ") + name;
    }
  }
  if (!unknown.empty()) gltf.ignored.insert("extensions are not supported and are ignored: " + unknown);
  if (gltf.uses("KHR_materials_variants"))
    gltf.ignored.insert("KHR_materials_variants is ignored: the default materials are imported");
}

void check_asset(const GltfLists& gltf) {
  const GltfPlace place{gltf.file};
  const Json* asset = find_object(gltf.root, "asset", place);
  const std::string version = asset ? string_member(*asset, "version") : "";
  if (!version.starts_with("2.")) {
    refuse_gltf(version.empty() ? "the glTF version is missing"
                                : fmt::format("glTF version {} is not supported, only version 2", version),
                place, "asset.version");
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

void check_materials(GltfLists& gltf) {
  gltf.each("materials", [&](const Json& material, const GltfPlace& place) {
    check_string(material, "name", place);
    check_numbers(material, "emissiveFactor", 3, place);
    check_texture_info(gltf, material, "emissiveTexture", place);
    check_texture_info(gltf, material, "normalTexture", place);
    if (const Json* normal = find_member(material, "normalTexture")) check_number(*normal, "scale", place);
    if (material.contains("occlusionTexture"))
      gltf.ignored.insert("occlusion textures are ignored: shading by nearby surfaces is computed");
    check_string(material, "alphaMode", place);
    const std::string alpha = string_member(material, "alphaMode");
    if (!alpha.empty() && alpha != "OPAQUE" && alpha != "MASK" && alpha != "BLEND")
      refuse_gltf("must be OPAQUE, MASK or BLEND", place, "alphaMode");
    check_number(material, "alphaCutoff", place);
    const Json* sides = find_member(material, "doubleSided");
    if (sides && !sides->is_boolean()) refuse_gltf("must be true or false", place, "doubleSided");
    if (const Json* pbr = find_object(material, "pbrMetallicRoughness", place)) {
      check_numbers(*pbr, "baseColorFactor", 4, place);
      check_number(*pbr, "metallicFactor", place);
      check_number(*pbr, "roughnessFactor", place);
      check_texture_info(gltf, *pbr, "baseColorTexture", place);
      check_texture_info(gltf, *pbr, "metallicRoughnessTexture", place);
    }
    check_specular_glossiness(gltf, material, place);
    if (const Json* extensions = find_object(material, "extensions", place)) {
      check_material_extensions(gltf, *extensions, place);
      const Json* coat = find_member(*extensions, "KHR_materials_clearcoat");
      if (coat && coat->contains("clearcoatNormalTexture"))
        gltf.ignored.insert("normal textures of KHR_materials_clearcoat are ignored: clear coats are smooth");
      if (coat && extensions->contains("KHR_materials_transmission"))
        gltf.ignored.insert("clear coats over glass are ignored: it reflects by its own coat");
      if (extensions->contains("KHR_materials_unlit"))
        gltf.ignored.insert("unlit materials are read as diffuse materials of their base colour");
    }
  });
}

/// The texture coordinate sets that textures use.
std::set<int> used_texcoords(const GltfLists& gltf) {
  std::set<int> sets;
  gltf.each("materials", [&](const Json& material, const GltfPlace& place) {
    const auto add = [&](const Json* owner, const char* key) {
      const Json* info = owner ? find_member(*owner, key) : nullptr;
      if (info) sets.insert(texcoord_set(*info, place));
    };
    const Json* pbr = find_member(material, "pbrMetallicRoughness");
    add(pbr, "baseColorTexture");
    add(pbr, "metallicRoughnessTexture");
    add(&material, "emissiveTexture");
    add(&material, "normalTexture");
    add(find_specular_glossiness(material, place), "diffuseTexture");
  });
  return sets;
}

/// Whether a node says by KHR_node_visibility that it is hidden.
bool is_hidden(const Json& node, const GltfPlace& place) {
  const Json* extension = find_extension(node, "KHR_node_visibility", place);
  const Json* visible = extension ? find_member(*extension, "visible") : nullptr;
  if (visible && !visible->is_boolean()) refuse_gltf("must be true or false", place, "KHR_node_visibility.visible");
  return visible && !visible->get<bool>();
}

/// Checks the nodes. Sets the parent of each node, -1 for a root, and which nodes are hidden themselves.
void check_nodes(GltfLists& gltf, std::vector<int>& parents, std::vector<char>& hidden) {
  std::vector<std::vector<int>> children(gltf.count("nodes"));
  gltf.each("nodes", [&](const Json& node, const GltfPlace& place) {
    check_string(node, "name", place);
    check_numbers(node, "matrix", 16, place);
    check_numbers(node, "translation", 3, place);
    check_numbers(node, "rotation", 4, place);
    check_numbers(node, "scale", 3, place);
    index_member(node, "mesh", gltf.count("meshes"), place);
    index_member(node, "camera", gltf.count("cameras"), place);
    check_weights(node, place);
    hidden.push_back(is_hidden(node, place));
    if (index_member(node, "skin", gltf.count("skins"), place) >= 0)
      gltf.ignored.insert(
          "animations of skins are ignored: skinned meshes are imported in the pose of the file's nodes");
    if (const Json* list = find_array(node, "children", place)) {
      for (const Json& child : *list) {
        children[place.index].push_back(checked_index(child, "children", children.size(), place));
      }
    }
  });
  check_node_trees(gltf.list("nodes"), gltf.list("scenes"), children, gltf.file);
  index_member(gltf.root, "scene", gltf.count("scenes"), {gltf.file});
  if (std::find(hidden.begin(), hidden.end(), 1) != hidden.end())
    gltf.ignored.insert("nodes that KHR_node_visibility hides are left out, with all nodes below them");
  parents.assign(children.size(), -1);
  for (std::size_t i = 0; i < children.size(); ++i)
    for (const int child : children[i]) parents[child] = static_cast<int>(i);
}

}  // namespace

CheckedGltf check_gltf(std::string_view json, const std::string& file, const GltfReadOptions& options) {
  const Json root = parse_gltf_json(json, file);
  GltfLists gltf(root, file);
  check_asset(gltf);
  check_extensions(gltf);
  CheckedGltf result;
  result.buffers = checked_data(gltf, "buffers");
  result.images = checked_data(gltf, "images");
  check_buffer_views(gltf, result.buffers);
  check_accessors(gltf);
  check_materials(gltf);
  check_textures(gltf);
  std::set<int> texcoord_sets = used_texcoords(gltf);
  if (options.texcoords) texcoord_sets.insert(0);
  check_meshes(gltf, texcoord_sets);
  result.meshopt_views = checked_meshopt_views(gltf);
  check_skins(gltf);
  result.instances = checked_instances(gltf);
  result.draco_primitives = checked_draco_primitives(gltf);
  check_nodes(gltf, result.parents, result.hidden);
  result.lights = checked_lights(gltf);
  result.node_lights = checked_node_lights(gltf, result.lights);
  result.light_profiles = checked_light_profiles(gltf);
  result.profile_lights = checked_profile_lights(gltf, result.light_profiles.size());
  result.node_light_extras = checked_light_extras(gltf, result);
  result.lenses = checked_lenses(gltf);
  std::set<std::string> animation_warnings;
  result.camera_channels = checked_camera_channels(gltf, result.parents, animation_warnings);
  if (options.animations) {
    result.node_channels = checked_node_channels(gltf, [](int, NodeChannel::Path) { return true; });
  } else {
    gltf.ignored.merge(animation_warnings);
  }
  result.ignored.assign(gltf.ignored.begin(), gltf.ignored.end());
  result.json = reduced_gltf(root, texcoord_sets).dump();
  return result;
}

}  // namespace patchlight

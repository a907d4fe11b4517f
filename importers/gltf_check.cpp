#include "importers/gltf_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "importers/gltf_animation_check.h"
#include "importers/gltf_json.h"
#include "importers/gltf_reduce.h"
#include "importers/gltf_texcoord_check.h"
#include "importers/gltf_tree_check.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr std::array kSupportedExtensions{"KHR_materials_emissive_strength", "KHR_materials_specular",
                                          "KHR_materials_ior", "KHR_materials_unlit"};

constexpr std::array kLists{"buffers",  "bufferViews", "images",  "accessors", "meshes", "materials",
                            "textures", "samplers",    "cameras", "nodes",     "scenes", "animations"};

constexpr std::size_t kMostTexcoords = 1000;  // sets of them that a mesh may have

/// A glTF file while it is checked.
struct Check {
  Check(const Json& gltf_root, const std::string& file_name) : root(gltf_root), file(file_name) {
    for (const char* key : kLists) lists[key] = &object_list(root, key, file);
  }

  const Json& root;
  const std::string& file;
  std::map<std::string_view, const Json*> lists;
  std::set<std::string> ignored;

  const Json& list(const char* key) const { return *lists.at(key); }
  std::size_t count(const char* key) const { return list(key).size(); }
  GltfPlace place(const char* key, std::size_t index, const Json& item) const { return {file, key, index, &item}; }

  /// Calls `check(item, place)` for each element of a list at the root.
  template <class CheckItem>
  void each(const char* key, const CheckItem& check) const {
    const Json& items = list(key);
    for (std::size_t i = 0; i < items.size(); ++i) check(items[i], place(key, i, items[i]));
  }
};

void check_asset(const Check& gltf) {
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

std::vector<GltfData> checked_data(const Check& gltf, const char* key) {
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

void check_buffer_views(const Check& gltf, const std::vector<GltfData>& buffers) {
  gltf.each("bufferViews", [&](const Json& view, const GltfPlace& place) {
    const int buffer = index_member(view, "buffer", buffers.size(), place);
    if (buffer < 0) refuse_gltf("has no buffer", place);
    const std::int64_t end = whole_number(view, "byteOffset", 0, place) + whole_number(view, "byteLength", 0, place);
    const std::int64_t stride = whole_number(view, "byteStride", 0, place);
    const std::size_t size = buffers[static_cast<std::size_t>(buffer)].size;
    if (static_cast<std::size_t>(end) > size) {
      refuse_gltf(fmt::format("ends at byte {} of a buffer of {}", end, size), place);
    }
    if (stride > 252 || stride % 4 != 0) refuse_gltf("must be a multiple of 4, at most 252", place, "byteStride");
  });
}

std::int64_t component_size(std::int64_t type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

std::int64_t component_count(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4" || type == "MAT2") return 4;
  if (type == "MAT3") return 9;
  return type == "MAT4" ? 16 : 0;
}

void check_accessors(const Check& gltf) {
  const Json& views = gltf.list("bufferViews");
  gltf.each("accessors", [&](const Json& accessor, const GltfPlace& place) {
    const std::int64_t size = component_size(whole_number(accessor, "componentType", 0, place)) *
                              component_count(string_member(accessor, "type"));
    if (size == 0) refuse_gltf("componentType or type is not one of glTF's", place);
    const std::int64_t count = whole_number(accessor, "count", 0, place);
    const std::int64_t offset = whole_number(accessor, "byteOffset", 0, place);
    const int view = index_member(accessor, "bufferView", views.size(), place);
    if (view < 0 || count == 0) return;
    const Json& source = views[static_cast<std::size_t>(view)];
    const std::int64_t length = whole_number(source, "byteLength", 0, place);
    const std::int64_t stated = whole_number(source, "byteStride", 0, place);
    const std::int64_t stride = stated > 0 ? stated : size;
    const bool fits = offset <= length && size <= length - offset && (count - 1) <= (length - offset - size) / stride;
    if (!fits) refuse_gltf(fmt::format("{} elements reach beyond bufferViews[{}]", count, view), place);
  });
}

/// An accessor that the importer reads itself.
void check_geometry(const Check& gltf, const Json& owner, const char* key, const std::string& type, bool index,
                    const GltfPlace& place) {
  const Json& accessors = gltf.list("accessors");
  const int number = index_member(owner, key, accessors.size(), place);
  if (number < 0) return;
  const Json& accessor = accessors[static_cast<std::size_t>(number)];
  const GltfPlace source = gltf.place("accessors", static_cast<std::size_t>(number), accessor);
  if (accessor.contains("sparse")) refuse_gltf("sparse accessors are not supported yet", source);
  const std::int64_t component = whole_number(accessor, "componentType", 0, source);
  const bool known = index ? component == 5121 || component == 5123 || component == 5125 : component == 5126;
  if (!known || string_member(accessor, "type") != type) {
    refuse_gltf(fmt::format("{} must be {} of {}", key, type, index ? "unsigned integers" : "32-bit floats"), source);
  }
  if (index && !accessor.contains("bufferView")) refuse_gltf("indices have no bufferView", source);
}

void check_mesh_primitive(Check& gltf, const Json& primitive, const GltfPlace& place) {
  if (!primitive.is_object()) refuse_gltf("must hold objects", place, "primitives");
  const Json* attributes = find_object(primitive, "attributes", place);
  if (!attributes) refuse_gltf("has a primitive without attributes", place);
  check_geometry(gltf, *attributes, "POSITION", "VEC3", false, place);
  check_geometry(gltf, *attributes, "NORMAL", "VEC3", false, place);
  check_geometry(gltf, primitive, "indices", "SCALAR", true, place);
  if (attributes->contains("NORMAL") && attributes->contains("POSITION")) {
    const Json& accessors = gltf.list("accessors");
    const auto count = [&](const char* key) {
      return whole_number(accessors[attributes->at(key).get<int>()], "count", 0, place);
    };
    if (count("NORMAL") != count("POSITION")) refuse_gltf("has unequal numbers of positions and normals", place);
  }
  index_member(primitive, "material", gltf.count("materials"), place);
  if (whole_number(primitive, "mode", 4, place) > 6) refuse_gltf("mode must be 0 to 6", place);
  const Json* targets = find_array(primitive, "targets", place);
  if (targets && !targets->empty()) gltf.ignored.insert("morph targets are not read: meshes stand in their base shape");
}

void check_meshes(Check& gltf) {
  gltf.each("meshes", [&](const Json& mesh, const GltfPlace& place) {
    check_string(mesh, "name", place);
    const Json* primitives = find_array(mesh, "primitives", place);
    if (!primitives) refuse_gltf("has no primitives", place);
    for (const Json& primitive : *primitives) check_mesh_primitive(gltf, primitive, place);
  });
}

void check_texture_info(const Check& gltf, const Json& owner, const char* key, const GltfPlace& place) {
  const Json* info = find_object(owner, key, place);
  if (!info) return;
  if (index_member(*info, "index", gltf.count("textures"), place) < 0) refuse_gltf("has no index", place, key);
  index_member(*info, "texCoord", kMostTexcoords, place);
}

void check_materials(Check& gltf) {
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

bool has_base_color_texture(const Check& gltf) {
  const Json& materials = gltf.list("materials");
  return std::any_of(materials.begin(), materials.end(), [](const Json& material) {
    const Json* pbr = find_member(material, "pbrMetallicRoughness");
    return pbr && pbr->contains("baseColorTexture");
  });
}

/// Returns the parent of each node, -1 of a root.
std::vector<int> check_nodes(Check& gltf) {
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
  std::vector<int> parents(children.size(), -1);
  for (std::size_t i = 0; i < children.size(); ++i)
    for (const int child : children[i]) parents[child] = static_cast<int>(i);
  return parents;
}

}  // namespace

CheckedGltf check_gltf(std::string_view json, const std::string& file, bool texcoords) {
  const Json root = parse_gltf_json(json, file);
  Check gltf(root, file);
  check_asset(gltf);
  CheckedGltf result;
  result.buffers = checked_data(gltf, "buffers");
  result.images = checked_data(gltf, "images");
  check_buffer_views(gltf, result.buffers);
  check_accessors(gltf);
  check_meshes(gltf);
  check_materials(gltf);
  texcoords = texcoords || has_base_color_texture(gltf);
  if (texcoords) check_texcoords(root, file);
  result.parents = check_nodes(gltf);
  result.camera_channels = camera_channels(root, result.parents, file, gltf.ignored);
  result.ignored.assign(gltf.ignored.begin(), gltf.ignored.end());
  result.json = reduced_gltf(root, texcoords).dump();
  return result;
}

}  // namespace patchlight

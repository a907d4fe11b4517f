#include "importers/gltf/check/reduced_gltf.h"

#include <fmt/format.h>

#include <initializer_list>

#include "importers/gltf/check/material_extensions.h"
#include "importers/gltf/check/specular_glossiness_check.h"
#include "importers/gltf/check/texture_check.h"

namespace patchlight {
namespace {

Json selected(const Json& object, std::initializer_list<const char*> keys) {
  Json result = Json::object();
  for (const char* key : keys) {
    if (const Json* member = find_member(object, key)) result[key] = *member;
  }
  return result;
}

template <class Reduce>
Json reduced_list(const Json& root, const char* key, const Reduce& reduce) {
  Json result = Json::array();
  if (const Json* list = find_member(root, key)) {
    for (const Json& item : *list) result.push_back(reduce(item));
  }
  return result;
}

/// Copies what the importer reads of `extras` from tinygltf: the light group, and how rays see the node.
void keep_extras(const Json& item, Json& result) {
  const Json* extras = find_member(item, "extras");
  if (extras && extras->is_object())
    result["extras"] = selected(*extras, {"light_group", "visible_camera", "intangible"});
}

Json reduced_node(const Json& node) {
  Json result = selected(
      node, {"name", "children", "matrix", "translation", "rotation", "scale", "mesh", "camera", "skin", "weights"});
  keep_extras(node, result);
  return result;
}

/// A texture whose `source` is the image to read. Without one, an extension that could have it is kept, for the
/// message.
Json with_source(const Json& texture) {
  Json result = selected(texture, {"sampler"});
  const int image = texture_image(texture);
  const Json* extensions = find_member(texture, "extensions");
  if (image >= 0)
    result["source"] = image;
  else if (extensions && extensions->contains(kBasisu))
    result["extensions"][kBasisu] = Json::object();
  return result;
}

Json reduced_texture(const Json& info) {
  Json result = selected(info, {"index", "texCoord"});
  const Json* extensions = find_member(info, "extensions");
  const Json* transform = extensions ? find_member(*extensions, "KHR_texture_transform") : nullptr;
  if (transform) {
    result["extensions"]["KHR_texture_transform"] = selected(*transform, {"offset", "scale", "rotation", "texCoord"});
  }
  return result;
}

Json reduced_material(const Json& material) {
  Json result = selected(material, {"name", "emissiveFactor", "doubleSided", "alphaMode", "alphaCutoff"});
  keep_extras(material, result);
  if (const Json* emissive = find_member(material, "emissiveTexture")) {
    result["emissiveTexture"] = reduced_texture(*emissive);
  }
  if (const Json* normal = find_member(material, "normalTexture")) {
    Json& reduced = result["normalTexture"] = reduced_texture(*normal);
    if (const Json* scale = find_member(*normal, "scale")) reduced["scale"] = *scale;
  }
  const std::string file;
  const Json* glossy = find_specular_glossiness(material, {file});
  const Json dielectric = glossy ? dielectric_of(*glossy) : Json();
  if (const Json* pbr = glossy ? &dielectric : find_member(material, "pbrMetallicRoughness")) {
    Json& reduced = result["pbrMetallicRoughness"] =
        selected(*pbr, {"baseColorFactor", "metallicFactor", "roughnessFactor"});
    for (const char* key : {"baseColorTexture", "metallicRoughnessTexture"}) {
      if (const Json* info = find_member(*pbr, key)) reduced[key] = reduced_texture(*info);
    }
  }
  if (glossy) {
    Json& reduced = result["extensions"][kSpecularGlossiness] =
        selected(*glossy, {"specularFactor", "glossinessFactor"});
    if (const Json* info = find_member(*glossy, "specularGlossinessTexture"))
      reduced["specularGlossinessTexture"] = selected(*info, {"index"});
  }
  if (const Json* extensions = find_member(material, "extensions")) {
    if (Json reduced = reduced_material_extensions(*extensions); !reduced.empty()) result["extensions"].update(reduced);
    if (find_member(*extensions, "KHR_materials_unlit")) result["extensions"]["KHR_materials_unlit"] = Json::object();
  }
  return result;
}

/// Whether a primitive has indices with a bufferView. Without one, tinygltf refuses them, as for Draco.
bool has_plain_indices(const Json& root, const Json& primitive) {
  const Json* indices = find_member(primitive, "indices");
  return indices && root.at("accessors").at(indices->get<std::size_t>()).contains("bufferView");
}

Json reduced_mesh(const Json& root, const Json& mesh, const std::set<int>& texcoord_sets) {
  Json result = selected(mesh, {"name", "weights"});
  result["primitives"] = reduced_list(mesh, "primitives", [&](const Json& primitive) {
    Json reduced = selected(primitive, {"indices", "material", "mode"});
    reduced["attributes"] = selected(primitive.at("attributes"), {"POSITION", "NORMAL", "COLOR_0"});
    for (int set = 0; set < kMaxJointSets && primitive.at("attributes").contains(fmt::format("JOINTS_{}", set)); ++set)
      reduced["attributes"].update(selected(
          primitive.at("attributes"), {fmt::format("JOINTS_{}", set).c_str(), fmt::format("WEIGHTS_{}", set).c_str()}));
    if (primitive.contains("targets")) {
      reduced["targets"] = reduced_list(primitive, "targets", [](const Json& target) {
        return selected(target, {"POSITION", "NORMAL"});
      });
    }
    for (const int set : texcoord_sets)
      reduced["attributes"].update(selected(primitive.at("attributes"), {fmt::format("TEXCOORD_{}", set).c_str()}));
    if (!reduced["attributes"].contains("POSITION") || !has_plain_indices(root, primitive)) reduced.erase("indices");
    return reduced;
  });
  return result;
}

double number_or_zero(const Json& object, const char* key) {
  const Json* member = find_member(object, key);
  return member && member->is_number() ? member->get<double>() : 0.0;
}

Json reduced_camera(const Json& camera) {
  const std::string type = string_member(camera, "type");
  const Json* lens = find_member(camera, type.c_str());
  const Json none = Json::object();
  if (!lens || !lens->is_object()) lens = &none;
  if (type == "orthographic") {
    return {{"type", type},
            {"orthographic",
             {{"xmag", number_or_zero(*lens, "xmag")},
              {"ymag", number_or_zero(*lens, "ymag")},
              {"znear", number_or_zero(*lens, "znear")},
              {"zfar", number_or_zero(*lens, "zfar")}}}};
  }
  const double angle = type == "perspective" ? number_or_zero(*lens, "yfov") : 0.0;
  return {{"type", "perspective"},
          {"perspective",
           {{"yfov", angle},
            {"aspectRatio", number_or_zero(*lens, "aspectRatio")},
            {"znear", number_or_zero(*lens, "znear")},
            {"zfar", number_or_zero(*lens, "zfar")}}}};
}

}  // namespace

Json reduced_gltf(const Json& root, const std::set<int>& texcoord_sets) {
  Json result = selected(root, {"scene"});
  result["asset"] = selected(root.at("asset"), {"version"});
  result["scenes"] = reduced_list(root, "scenes", [](const Json& scene) { return selected(scene, {"nodes"}); });
  result["nodes"] = reduced_list(root, "nodes", reduced_node);
  result["meshes"] =
      reduced_list(root, "meshes", [&](const Json& mesh) { return reduced_mesh(root, mesh, texcoord_sets); });
  result["materials"] = reduced_list(root, "materials", reduced_material);
  result["cameras"] = reduced_list(root, "cameras", reduced_camera);
  result["skins"] = reduced_list(root, "skins", [](const Json& skin) {
    return selected(skin, {"joints", "inverseBindMatrices"});
  });
  result["textures"] = reduced_list(root, "textures", with_source);
  result["samplers"] = reduced_list(root, "samplers", [](const Json& sampler) {
    return selected(sampler, {"magFilter", "wrapS", "wrapT"});
  });
  result["accessors"] = reduced_list(root, "accessors", [](const Json& accessor) {
    return selected(accessor, {"bufferView", "byteOffset", "componentType", "count", "type", "normalized", "sparse"});
  });
  result["bufferViews"] = reduced_list(root, "bufferViews", [](const Json& view) {
    return selected(view, {"buffer", "byteOffset", "byteLength", "byteStride"});
  });
  return result;
}

}  // namespace patchlight

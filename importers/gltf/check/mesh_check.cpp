#include "importers/gltf/check/mesh_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace patchlight {
namespace {

/// Component type of an accessor.
struct Component {
  std::int64_t type;
  bool normalized;

  bool operator==(const Component&) const = default;
};

constexpr Component kByte{5120, false}, kUnsignedByte{5121, false}, kShort{5122, false}, kUnsignedShort{5123, false},
    kFloat{5126, false}, kNormByte{5120, true}, kNormUnsignedByte{5121, true}, kNormShort{5122, true},
    kNormUnsignedShort{5123, true};

/// Types that glTF permits for an attribute.
struct AttributeRule {
  std::string shape;  ///< Empty: VEC3 or VEC4.
  std::vector<Component> plain;
  std::vector<Component> quantized;  ///< Also permitted, with KHR_mesh_quantization.
  const char* text;                  ///< `plain` in words, for messages.
};

const AttributeRule kPosition{
    "VEC3",
    {kFloat},
    {kByte, kNormByte, kUnsignedByte, kNormUnsignedByte, kShort, kNormShort, kUnsignedShort, kNormUnsignedShort},
    "VEC3 of 32-bit floats"};
const AttributeRule kNormal{"VEC3", {kFloat}, {kNormByte, kNormShort}, "VEC3 of 32-bit floats"};
const AttributeRule kTexcoord{"VEC2",
                              {kFloat, kNormUnsignedByte, kNormUnsignedShort},
                              {kByte, kNormByte, kUnsignedByte, kShort, kNormShort, kUnsignedShort},
                              "VEC2 of 32-bit floats or of normalized unsigned bytes or shorts"};

const AttributeRule kColor{"",
                           {kFloat, kNormUnsignedByte, kNormUnsignedShort},
                           {},
                           "VEC3 or VEC4 of 32-bit floats or of normalized unsigned bytes or shorts"};

const AttributeRule kJoints{"VEC4", {kUnsignedByte, kUnsignedShort}, {}, "VEC4 of unsigned bytes or shorts"};
const AttributeRule kWeights{"VEC4",
                             {kFloat, kNormUnsignedByte, kNormUnsignedShort},
                             {},
                             "VEC4 of 32-bit floats or of normalized unsigned bytes or shorts"};
const AttributeRule kTarget{"VEC3", {kFloat}, {kByte, kNormByte, kShort, kNormShort}, "VEC3 of 32-bit floats"};

/// Checks an attribute's type. Returns its element count; -1 if it is absent.
std::int64_t checked_attribute(const GltfLists& gltf, const Json& attributes, const std::string& key,
                               const AttributeRule& rule, bool quantized, const GltfPlace& mesh) {
  const int number = index_member(attributes, key.c_str(), gltf.count("accessors"), mesh);
  if (number < 0) return -1;
  const GltfPlace place = gltf.place("accessors", static_cast<std::size_t>(number));
  const Json& accessor = *place.item;
  const Json* normalized = find_member(accessor, "normalized");
  const Component component{whole_number(accessor, "componentType", 0, place), normalized && normalized->get<bool>()};
  const auto among = [&](const std::vector<Component>& list) {
    return std::find(list.begin(), list.end(), component) != list.end();
  };
  const bool known = among(rule.plain) || (quantized && among(rule.quantized));
  const std::string shape = string_member(accessor, "type");
  if (!known || (rule.shape.empty() ? shape != "VEC3" && shape != "VEC4" : shape != rule.shape)) {
    refuse_gltf(fmt::format("{} must be {}", key, rule.text), place);
  }
  return whole_number(accessor, "count", 0, place);
}

void check_indices(const GltfLists& gltf, const Json& primitive, const GltfPlace& mesh) {
  const int number = index_member(primitive, "indices", gltf.count("accessors"), mesh);
  if (number < 0) return;
  const GltfPlace place = gltf.place("accessors", static_cast<std::size_t>(number));
  const std::int64_t component = whole_number(*place.item, "componentType", 0, place);
  const bool known = component == 5121 || component == 5123 || component == 5125;
  if (!known || string_member(*place.item, "type") != "SCALAR") {
    refuse_gltf("indices must be SCALAR of unsigned integers", place);
  }
  const bool compressed = find_extension(primitive, "KHR_draco_mesh_compression", mesh) != nullptr;
  if (!compressed && !place.item->contains("bufferView")) refuse_gltf("indices have no bufferView", place);
}

void check_primitive(GltfLists& gltf, const Json& primitive, const std::set<int>& texcoord_sets, bool quantized,
                     const GltfPlace& place) {
  if (!primitive.is_object()) refuse_gltf("must contain objects", place, "primitives");
  const Json* attributes = find_object(primitive, "attributes", place);
  if (!attributes) refuse_gltf("has a primitive without attributes", place);
  const std::int64_t vertices = checked_attribute(gltf, *attributes, "POSITION", kPosition, quantized, place);
  const auto check = [&](const std::string& key, const AttributeRule& rule, const char* what) {
    const std::int64_t count = checked_attribute(gltf, *attributes, key, rule, quantized, place);
    if (count >= 0 && vertices >= 0 && count != vertices) {
      refuse_gltf(fmt::format("has unequal counts of positions and {}", what), place);
    }
  };
  check("NORMAL", kNormal, "normals");
  for (const int set : texcoord_sets) check(fmt::format("TEXCOORD_{}", set), kTexcoord, "texture coordinates");
  check("COLOR_0", kColor, "colours");
  check_indices(gltf, primitive, place);
  index_member(primitive, "material", gltf.count("materials"), place);
  if (whole_number(primitive, "mode", 4, place) > 6) refuse_gltf("mode must be 0 to 6", place);
  for (int set = 0; set < kMaxJointSets && attributes->contains(fmt::format("JOINTS_{}", set)); ++set) {
    check(fmt::format("JOINTS_{}", set), kJoints, "joints");
    check(fmt::format("WEIGHTS_{}", set), kWeights, "weights");
  }
  const Json* targets = find_array(primitive, "targets", place);
  for (std::size_t i = 0; targets && i < targets->size(); ++i) {
    if (!(*targets)[i].is_object()) refuse_gltf("must contain objects", place, "targets");
    for (const char* key : {"POSITION", "NORMAL"}) {
      const std::int64_t count = checked_attribute(gltf, (*targets)[i], key, kTarget, quantized, place);
      if (count >= 0 && vertices >= 0 && count != vertices)
        refuse_gltf("has a morph target with another number of vertices", place);
    }
    gltf.ignored.insert("animations of morph targets are ignored: meshes are imported with the file's initial weights");
  }
}

}  // namespace

void check_meshes(GltfLists& gltf, const std::set<int>& texcoord_sets) {
  const bool quantized = gltf.uses("KHR_mesh_quantization");
  gltf.each("meshes", [&](const Json& mesh, const GltfPlace& place) {
    check_string(mesh, "name", place);
    check_weights(mesh, place);
    const Json* primitives = find_array(mesh, "primitives", place);
    if (!primitives) refuse_gltf("has no primitives", place);
    for (const Json& primitive : *primitives) check_primitive(gltf, primitive, texcoord_sets, quantized, place);
  });
}

}  // namespace patchlight

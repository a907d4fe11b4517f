#include "importers/gltf_texcoord_check.h"

namespace patchlight {
namespace {

bool is_normalized(const Json& accessor) {
  const Json* member = find_member(accessor, "normalized");
  return member && member->is_boolean() && member->get<bool>();
}

void check_texcoord(const Json& accessors, const Json& attributes, const std::string& file, const GltfPlace& mesh) {
  const int index = index_member(attributes, "TEXCOORD_0", accessors.size(), mesh);
  const int positions = index_member(attributes, "POSITION", accessors.size(), mesh);
  if (index < 0 || positions < 0) return;
  const Json& accessor = accessors[static_cast<std::size_t>(index)];
  const GltfPlace place{file, "accessors", static_cast<std::size_t>(index), &accessor};
  if (accessor.contains("sparse")) refuse_gltf("sparse accessors are not supported yet", place);
  const std::int64_t type = whole_number(accessor, "componentType", 0, place);
  const bool known = type == 5126 || ((type == 5121 || type == 5123) && is_normalized(accessor));
  if (!known || string_member(accessor, "type") != "VEC2") {
    refuse_gltf("TEXCOORD_0 must be VEC2 of 32-bit floats or of normalized unsigned bytes or shorts", place);
  }
  if (whole_number(accessor, "count", 0, place) != whole_number(accessors[positions], "count", 0, place)) {
    refuse_gltf("has unequal numbers of positions and texture coordinates", mesh);
  }
}

}  // namespace

void check_texcoords(const Json& root, const std::string& file) {
  const Json& accessors = object_list(root, "accessors", file);
  const Json& meshes = object_list(root, "meshes", file);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const GltfPlace place{file, "meshes", i, &meshes[i]};
    for (const Json& primitive : meshes[i].at("primitives"))
      check_texcoord(accessors, primitive.at("attributes"), file, place);
  }
}

}  // namespace patchlight

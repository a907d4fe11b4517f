#include "importers/gltf/check/deform_check.h"

#include <fmt/format.h>

namespace patchlight {
namespace {

/// Checks an accessor of floats, or with `small` also of normalized bytes or shorts. Returns its element count.
std::int64_t checked_count(const GltfLists& gltf, int accessor, const char* shape, bool small, const GltfPlace& owner) {
  const GltfPlace place = gltf.place("accessors", static_cast<std::size_t>(accessor));
  const std::int64_t component = whole_number(*place.item, "componentType", 0, place);
  const Json* normalized = find_member(*place.item, "normalized");
  const bool normalized_integer = (component == 5120 || component == 5122) && normalized && normalized->get<bool>();
  if (string_member(*place.item, "type") != shape || (component != 5126 && !(small && normalized_integer))) {
    refuse_gltf(fmt::format("must be {} of 32-bit floats{} for {}", shape, small ? ", or of normalized integers," : "",
                            owner.text()),
                place);
  }
  return whole_number(*place.item, "count", 0, place);
}

}  // namespace

std::map<int, GltfInstances> checked_instances(const GltfLists& gltf) {
  std::map<int, GltfInstances> result;
  gltf.each("nodes", [&](const Json& node, const GltfPlace& place) {
    const Json* extension = find_extension(node, "EXT_mesh_gpu_instancing", place);
    const Json* attributes = extension ? find_object(*extension, "attributes", place) : nullptr;
    if (!attributes) return;
    GltfInstances instances;
    bool first = true;
    for (const char* key : {"TRANSLATION", "ROTATION", "SCALE"}) {
      const int accessor = index_member(*attributes, key, gltf.count("accessors"), place);
      if (accessor < 0) continue;
      if (!gltf.list("accessors")[static_cast<std::size_t>(accessor)].contains("bufferView"))
        refuse_gltf(fmt::format("has instances with accessors[{}], which has no bufferView", accessor), place);
      const bool rotation = key == std::string_view("ROTATION");
      const auto count =
          static_cast<std::size_t>(checked_count(gltf, accessor, rotation ? "VEC4" : "VEC3", rotation, place));
      if (!first && count != instances.count) refuse_gltf("has instance attributes of unequal counts", place);
      instances.count = count;
      instances.attributes[key] = accessor;
      first = false;
    }
    if (!first) result[static_cast<int>(place.index)] = instances;
  });
  return result;
}

void check_skins(const GltfLists& gltf) {
  gltf.each("skins", [&](const Json& skin, const GltfPlace& place) {
    const Json* joints = find_array(skin, "joints", place);
    if (!joints || joints->empty()) refuse_gltf("has no joints", place);
    for (const Json& joint : *joints) checked_index(joint, "joints", gltf.count("nodes"), place);
    const int matrices = index_member(skin, "inverseBindMatrices", gltf.count("accessors"), place);
    if (matrices < 0) return;
    const auto count = static_cast<std::size_t>(checked_count(gltf, matrices, "MAT4", false, place));
    if (count < joints->size()) {
      refuse_gltf(fmt::format("has {} matrices for {} joints", count, joints->size()), place);
    }
  });
}

}  // namespace patchlight

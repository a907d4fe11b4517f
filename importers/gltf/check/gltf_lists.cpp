#include "importers/gltf/check/gltf_lists.h"

#include <algorithm>
#include <array>

namespace patchlight {
namespace {

constexpr std::array kLists{"buffers",  "bufferViews", "images", "accessors", "meshes", "materials", "textures",
                            "samplers", "cameras",     "nodes",  "scenes",    "skins",  "animations"};

}  // namespace

GltfLists::GltfLists(const Json& gltf_root, const std::string& file_name) : root(gltf_root), file(file_name) {
  for (const char* key : kLists) lists[key] = &object_list(root, key, file);
}

bool GltfLists::uses(const char* extension) const {
  for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
    const Json* names = find_array(root, key, {file});
    if (names && std::find(names->begin(), names->end(), extension) != names->end()) return true;
  }
  return false;
}

const Json* find_extension(const Json& object, const char* name, const GltfPlace& place) {
  const Json* extensions = find_object(object, "extensions", place);
  return extensions ? find_object(*extensions, name, place) : nullptr;
}

int texcoord_set(const Json& info, const GltfPlace& place) {
  const Json* transform = find_extension(info, "KHR_texture_transform", place);
  const Json& stated = transform && transform->contains("texCoord") ? *transform : info;
  return static_cast<int>(whole_number(stated, "texCoord", 0, place));
}

}  // namespace patchlight

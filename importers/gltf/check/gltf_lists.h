#pragma once
// Internal to importers/gltf: includes nlohmann/json.
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "importers/gltf/check/gltf_json.h"

namespace patchlight {

/// Maximum number of JOINTS_n attributes, of four joints each.
constexpr int kMaxJointSets = 64;

constexpr const char* kLightList = "KHR_lights_punctual.lights";  ///< For messages.

/// A glTF file during its check: the lists at the root, whose elements are objects.
struct GltfLists {
  /// Throws: Error (bad_data) for a list that is not an array of objects.
  GltfLists(const Json& gltf_root, const std::string& file_name);

  const Json& root;
  const std::string& file;
  std::map<std::string_view, const Json*> lists;
  std::set<std::string> ignored;  ///< Warnings of contents that are not imported.

  const Json& list(const char* key) const { return *lists.at(key); }
  std::size_t count(const char* key) const { return list(key).size(); }
  GltfPlace place(const char* key, std::size_t index) const { return {file, key, index, &list(key)[index]}; }

  /// Whether extensionsUsed or extensionsRequired contains an extension.
  bool uses(const char* extension) const;

  /// Calls `check(item, place)` for each element of a list at the root.
  template <class CheckItem>
  void each(const char* key, const CheckItem& check) const {
    const Json& items = list(key);
    for (std::size_t i = 0; i < items.size(); ++i) check(items[i], GltfPlace{file, key, i, &items[i]});
  }
};

/// An extension's object in `extensions`; null if it is absent.
const Json* find_extension(const Json& object, const char* name, const GltfPlace& place);

/// The texture coordinate set that a checked textureInfo uses.
int texcoord_set(const Json& info, const GltfPlace& place);

}  // namespace patchlight

#pragma once
// Internal to the glTF files of this folder: brings nlohmann/json along.
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "importers/gltf/check/gltf_json.h"

namespace patchlight {

/// Sets of four joints, of which each is checked and read, that a skin's vertices may hang on.
constexpr int kMostBones = 64;

constexpr const char* kLightList = "KHR_lights_punctual.lights";  ///< As messages name it.

/// A glTF file while it is checked: its lists at the root, whose elements are objects.
struct GltfLists {
  /// Throws: Error (bad_data) for a list that is none.
  GltfLists(const Json& gltf_root, const std::string& file_name);

  const Json& root;
  const std::string& file;
  std::map<std::string_view, const Json*> lists;
  std::set<std::string> ignored;  ///< What the scene holds beyond what is read, one warning each.

  const Json& list(const char* key) const { return *lists.at(key); }
  std::size_t count(const char* key) const { return list(key).size(); }
  GltfPlace place(const char* key, std::size_t index) const { return {file, key, index, &list(key)[index]}; }

  /// Whether the file says that it uses an extension.
  bool uses(const char* extension) const;

  /// Calls `check(item, place)` for each element of a list at the root.
  template <class CheckItem>
  void each(const char* key, const CheckItem& check) const {
    const Json& items = list(key);
    for (std::size_t i = 0; i < items.size(); ++i) check(items[i], GltfPlace{file, key, i, &items[i]});
  }
};

/// An extension's object in an object's `extensions`, or null where it is absent.
const Json* find_extension(const Json& object, const char* name, const GltfPlace& place);

/// The set of texture coordinates that a checked textureInfo's texture lies by.
int texcoord_set(const Json& info, const GltfPlace& place);

}  // namespace patchlight

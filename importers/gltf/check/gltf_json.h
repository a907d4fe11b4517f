#pragma once
// Internal to importers/gltf: includes nlohmann/json.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace patchlight {

using Json = nlohmann::json;

/// A location in a glTF file. Formatted only when a message needs it.
struct GltfPlace {
  const std::string& file;
  const char* list = "";  ///< "accessors", "nodes", ...; empty: the root.
  std::size_t index = 0;
  const Json* item = nullptr;  ///< The element, for its name; null: unnamed.

  /// For messages, such as: scene.glb, nodes[0] 'box'.mesh
  std::string text(std::string_view member = "") const;
};

/// Throws: Error (bad_data).
[[noreturn]] void refuse_gltf(const std::string& what, const GltfPlace& place, std::string_view member = "");

/// Parses JSON text. Throws: Error (bad_data) for a syntax error, a root that is not an object, or nesting deeper than
/// 128, which could overflow the stack of recursive parsers.
Json parse_gltf_json(std::string_view text, const std::string& file);

/// A member of an object; null if it is absent. Throw: Error (bad_data) for a member of another type.
const Json* find_member(const Json& object, const char* key);
const Json* find_object(const Json& object, const char* key, const GltfPlace& place);
const Json* find_array(const Json& object, const char* key, const GltfPlace& place);
/// A list of objects at the root; empty if it is absent. Throws: Error (bad_data) for other types.
const Json& object_list(const Json& root, const char* key, const std::string& file);

/// Numbers and strings below throw Error (bad_data) for another type or a value out of range.

/// A whole number in [0, 2^53]; `fallback` if absent.
std::int64_t whole_number(const Json& object, const char* key, std::int64_t fallback, const GltfPlace& place);
/// An index below `count`; -1 if absent.
int index_member(const Json& object, const char* key, std::size_t count, const GltfPlace& place);
int checked_index(const Json& value, const char* key, std::size_t count, const GltfPlace& place);
void check_number(const Json& object, const char* key, const GltfPlace& place);
void check_numbers(const Json& object, const char* key, std::size_t count, const GltfPlace& place);
/// Checks `weights` of morph targets, in a node or a mesh: an array of numbers.
void check_weights(const Json& object, const GltfPlace& place);
void check_string(const Json& object, const char* key, const GltfPlace& place);
/// Empty if absent or of another type.
std::string string_member(const Json& object, const char* key);

}  // namespace patchlight

#pragma once
// Internal to the glTF files of this folder: brings nlohmann/json along.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace patchlight {

using Json = nlohmann::json;

/// Where in a glTF file something stands; written out only when it has to be named.
struct GltfPlace {
  const std::string& file;
  const char* list = "";  ///< "accessors", "nodes", ...; empty: the root.
  std::size_t index = 0;
  const Json* item = nullptr;  ///< Its name helps the user more than its index.

  std::string text(std::string_view member = "") const;
};

[[noreturn]] void refuse_gltf(const std::string& what, const GltfPlace& place, std::string_view member = "");

/// Parses JSON text. Throws: Error (bad_data) for broken syntax, a root that is no object, or nesting deeper than 128,
/// which parsers that recurse would not survive.
Json parse_gltf_json(std::string_view text, const std::string& file);

/// A member of an object, or null where it is absent. Each refuses (Error, bad_data) a member of another type.
const Json* find_member(const Json& object, const char* key);
const Json* find_object(const Json& object, const char* key, const GltfPlace& place);
const Json* find_array(const Json& object, const char* key, const GltfPlace& place);
/// Elements of a list at the root, each an object; an empty list where it is absent.
const Json& object_list(const Json& root, const char* key, const std::string& file);

/// A whole number in [0, 2^53]; `fallback` where absent.
std::int64_t whole_number(const Json& object, const char* key, std::int64_t fallback, const GltfPlace& place);
/// An index below `count`; -1 where absent.
int index_member(const Json& object, const char* key, std::size_t count, const GltfPlace& place);
int checked_index(const Json& value, const char* key, std::size_t count, const GltfPlace& place);
void check_number(const Json& object, const char* key, const GltfPlace& place);
void check_numbers(const Json& object, const char* key, std::size_t count, const GltfPlace& place);
/// Numbers, however many. Of morph targets, in a node or a mesh.
void check_weights(const Json& object, const GltfPlace& place);
void check_string(const Json& object, const char* key, const GltfPlace& place);
std::string string_member(const Json& object, const char* key);

}  // namespace patchlight

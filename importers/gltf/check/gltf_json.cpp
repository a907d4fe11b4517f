#include "importers/gltf/check/gltf_json.h"

#include <fmt/format.h>

#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr int kMaxNesting = 128;

const char* const kRemedy = "export the scene again; a glTF validator lists all faults";

int nesting(std::string_view text) {
  int depth = 0;
  int deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return deepest;
}

}  // namespace

std::string GltfPlace::text(std::string_view member) const {
  std::string where = file;
  if (*list) where += fmt::format(", {}[{}]", list, index);
  const std::string name = item && item->is_object() ? string_member(*item, "name") : "";
  if (!name.empty()) where += fmt::format(" '{}'", name);
  if (!member.empty()) where += fmt::format("{}{}", *list ? "." : ", ", member);
  return where;
}

void refuse_gltf(const std::string& what, const GltfPlace& place, std::string_view member) {
  throw Error(ExitCode::bad_data, what, place.text(member), kRemedy);
}

Json parse_gltf_json(std::string_view text, const std::string& file) {
  const GltfPlace place{file};
  if (nesting(text) > kMaxNesting) refuse_gltf(fmt::format("JSON nests deeper than {} levels", kMaxNesting), place);
  Json root;
  try {
    root = Json::parse(text);
  } catch (const Json::exception& fault) {
    refuse_gltf(fmt::format("not glTF: {}", fault.what()), place);
  }
  if (!root.is_object()) refuse_gltf("not glTF: the root of the JSON is not an object", place);
  return root;
}

const Json* find_member(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

const Json* find_object(const Json& object, const char* key, const GltfPlace& place) {
  const Json* member = find_member(object, key);
  if (member && !member->is_object()) refuse_gltf("must be an object", place, key);
  return member;
}

const Json* find_array(const Json& object, const char* key, const GltfPlace& place) {
  const Json* member = find_member(object, key);
  if (member && !member->is_array()) refuse_gltf("must be an array", place, key);
  return member;
}

const Json& object_list(const Json& root, const char* key, const std::string& file) {
  static const Json empty = Json::array();
  const Json* list = find_array(root, key, {file});
  if (!list) return empty;
  for (std::size_t i = 0; i < list->size(); ++i) {
    if (!(*list)[i].is_object()) refuse_gltf("must be an object", {file, key, i});
  }
  return *list;
}

std::int64_t whole_number(const Json& object, const char* key, std::int64_t fallback, const GltfPlace& place) {
  constexpr std::int64_t largest = std::int64_t{1} << 53;
  const Json* member = find_member(object, key);
  if (!member) return fallback;
  const bool valid = member->is_number_unsigned()  ? member->get<std::uint64_t>() <= static_cast<std::uint64_t>(largest)
                     : member->is_number_integer() ? member->get<std::int64_t>() >= 0
                                                   : false;
  if (!valid) refuse_gltf("must be a whole number from 0 to 2^53", place, key);
  return member->get<std::int64_t>();
}

int checked_index(const Json& value, const char* key, std::size_t count, const GltfPlace& place) {
  if (!value.is_number_integer()) refuse_gltf("must be an index", place, key);
  const bool valid = value.is_number_unsigned() && value.get<std::uint64_t>() < count;
  if (!valid)
    refuse_gltf(fmt::format("index {} is out of range; the list has {} elements", value.dump(), count), place, key);
  return value.get<int>();
}

int index_member(const Json& object, const char* key, std::size_t count, const GltfPlace& place) {
  const Json* member = find_member(object, key);
  return member ? checked_index(*member, key, count, place) : -1;
}

void check_number(const Json& object, const char* key, const GltfPlace& place) {
  const Json* member = find_member(object, key);
  if (member && !member->is_number()) refuse_gltf("must be a number", place, key);
}

void check_numbers(const Json& object, const char* key, std::size_t count, const GltfPlace& place) {
  const Json* member = find_array(object, key, place);
  if (!member) return;
  bool valid = member->size() == count;
  for (const Json& value : *member) valid = valid && value.is_number();
  if (!valid) refuse_gltf(fmt::format("must be {} numbers", count), place, key);
}

void check_weights(const Json& object, const GltfPlace& place) {
  if (const Json* weights = find_array(object, "weights", place))
    check_numbers(object, "weights", weights->size(), place);
}

void check_string(const Json& object, const char* key, const GltfPlace& place) {
  const Json* member = find_member(object, key);
  if (member && !member->is_string()) refuse_gltf("must be text", place, key);
}

std::string string_member(const Json& object, const char* key) {
  const Json* member = find_member(object, key);
  return member && member->is_string() ? member->get<std::string>() : "";
}

}  // namespace patchlight

#include "importers/gltf/check/accessor_check.h"

#include <fmt/format.h>

namespace patchlight {
namespace {

constexpr std::int64_t kMaxSparseCount = 1 << 22;  // elements of a sparse accessor without a bufferView
constexpr std::int64_t kMaxSparseOffset = (std::int64_t{1} << 31) - 1;  // tinygltf stores it as an int

std::int64_t component_count(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4" || type == "MAT2") return 4;
  if (type == "MAT3") return 9;
  return type == "MAT4" ? 16 : 0;
}

/// Checks that `count` elements of `size` bytes, from the owner's byteOffset on, lie within a bufferView. `strided`:
/// its byteStride applies.
void check_range(const GltfLists& gltf, const Json& owner, int view, std::int64_t count, std::int64_t size,
                 bool strided, const GltfPlace& place) {
  const Json& source = gltf.list("bufferViews")[static_cast<std::size_t>(view)];
  const std::int64_t offset = whole_number(owner, "byteOffset", 0, place);
  const std::int64_t length = whole_number(source, "byteLength", 0, place);
  const std::int64_t stated = strided ? whole_number(source, "byteStride", 0, place) : 0;
  const std::int64_t stride = stated > 0 ? stated : size;
  const bool fits = offset <= length && size <= length - offset && (count - 1) <= (length - offset - size) / stride;
  if (!fits) refuse_gltf(fmt::format("{} elements reach beyond bufferViews[{}]", count, view), place);
}

/// Checks a sparse accessor's indices or values. `size`: bytes of an element; 0: indices.
void check_sparse_part(const GltfLists& gltf, const Json& sparse, const char* key, std::int64_t count,
                       std::int64_t size, const GltfPlace& place) {
  const Json* part = find_object(sparse, key, place);
  const int view = part ? index_member(*part, "bufferView", gltf.count("bufferViews"), place) : -1;
  if (view < 0) refuse_gltf(fmt::format("sparse.{} has no bufferView", key), place);
  if (size == 0) {
    const std::int64_t type = whole_number(*part, "componentType", 0, place);
    if (type != 5121 && type != 5123 && type != 5125) refuse_gltf("must be unsigned integers", place, "sparse.indices");
    size = component_size(type);
  }
  if (whole_number(*part, "byteOffset", 0, place) > kMaxSparseOffset)
    refuse_gltf("has a byteOffset that is too large", place, "sparse");
  check_range(gltf, *part, view, count, size, false, place);
}

void check_sparse(const GltfLists& gltf, const Json& accessor, std::int64_t size, const GltfPlace& place) {
  const Json* sparse = find_object(accessor, "sparse", place);
  if (!sparse) return;
  const std::int64_t all = whole_number(accessor, "count", 0, place);
  const std::int64_t count = whole_number(*sparse, "count", 0, place);
  if (count < 1 || count > all) refuse_gltf(fmt::format("{} of {} elements are sparse", count, all), place);
  if (!accessor.contains("bufferView") && all > kMaxSparseCount) {
    refuse_gltf(fmt::format("a sparse accessor without a bufferView has {} elements; at most {} are supported", all,
                            kMaxSparseCount),
                place);
  }
  check_sparse_part(gltf, *sparse, "indices", count, 0, place);
  check_sparse_part(gltf, *sparse, "values", count, size, place);
}

}  // namespace

std::int64_t component_size(std::int64_t component_type) {
  switch (component_type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

void check_buffer_views(const GltfLists& gltf, const std::vector<GltfData>& buffers) {
  gltf.each("bufferViews", [&](const Json& view, const GltfPlace& place) {
    const int buffer = index_member(view, "buffer", buffers.size(), place);
    if (buffer < 0) refuse_gltf("has no buffer", place);
    const std::int64_t end = whole_number(view, "byteOffset", 0, place) + whole_number(view, "byteLength", 0, place);
    const std::int64_t stride = whole_number(view, "byteStride", 0, place);
    const std::size_t size = buffers[static_cast<std::size_t>(buffer)].size;
    if (static_cast<std::size_t>(end) > size) {
      refuse_gltf(fmt::format("ends at byte {} of a buffer of {}", end, size), place);
    }
    if (stride > 252 || stride % 4 != 0) refuse_gltf("must be a multiple of 4, at most 252", place, "byteStride");
  });
}

void check_accessors(const GltfLists& gltf) {
  gltf.each("accessors", [&](const Json& accessor, const GltfPlace& place) {
    const std::int64_t size = component_size(whole_number(accessor, "componentType", 0, place)) *
                              component_count(string_member(accessor, "type"));
    if (size == 0) refuse_gltf("has a componentType or type that glTF does not define", place);
    const std::int64_t count = whole_number(accessor, "count", 0, place);
    const int view = index_member(accessor, "bufferView", gltf.count("bufferViews"), place);
    const Json* normalized = find_member(accessor, "normalized");
    if (normalized && !normalized->is_boolean()) refuse_gltf("must be true or false", place, "normalized");
    if (view >= 0 && count > 0) check_range(gltf, accessor, view, count, size, true, place);
    check_sparse(gltf, accessor, size, place);
  });
}

}  // namespace patchlight

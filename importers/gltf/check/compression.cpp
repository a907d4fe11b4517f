#include "importers/gltf/check/compression.h"

#include <fmt/format.h>

#include "importers/gltf/check/gltf_lists.h"

namespace patchlight {
namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";

MeshoptView::Mode mode_of(const Json& compressed, const GltfPlace& place, const char* extension) {
  const std::string mode = string_member(compressed, "mode");
  if (mode == "ATTRIBUTES") return MeshoptView::Mode::attributes;
  if (mode == "TRIANGLES") return MeshoptView::Mode::triangles;
  if (mode != "INDICES") refuse_gltf(fmt::format("has the unknown mode '{}'", mode.substr(0, 100)), place, extension);
  return MeshoptView::Mode::indices;
}

MeshoptView::Filter filter_of(const Json& compressed, const GltfPlace& place, const char* extension, bool khr) {
  const std::string filter = string_member(compressed, "filter");
  if (filter == "OCTAHEDRAL") return MeshoptView::Filter::octahedral;
  if (filter == "QUATERNION") return MeshoptView::Filter::quaternion;
  if (filter == "EXPONENTIAL") return MeshoptView::Filter::exponential;
  if (filter == "COLOR" && khr) return MeshoptView::Filter::color;
  if (!filter.empty() && filter != "NONE")
    refuse_gltf(fmt::format("has the unknown filter '{}'", filter.substr(0, 100)), place, extension);
  return MeshoptView::Filter::none;
}

/// Whether the mode and the filter permit this stride and count.
bool is_valid_stride(const MeshoptView& compressed) {
  const std::size_t stride = compressed.stride;
  if (compressed.mode != MeshoptView::Mode::attributes) {
    const bool whole_triangles = compressed.mode == MeshoptView::Mode::indices || compressed.count % 3 == 0;
    return (stride == 2 || stride == 4) && whole_triangles && compressed.filter == MeshoptView::Filter::none;
  }
  if (compressed.filter == MeshoptView::Filter::octahedral || compressed.filter == MeshoptView::Filter::color)
    return stride == 4 || stride == 8;
  if (compressed.filter == MeshoptView::Filter::quaternion) return stride == 8;
  return stride % 4 == 0 && stride >= 4 && stride <= 256;
}

/// Whether an accessor, if present, has a bufferView.
bool has_buffer_view(const GltfLists& gltf, const Json& object, const char* key, const GltfPlace& place) {
  const int accessor = index_member(object, key, gltf.count("accessors"), place);
  return accessor < 0 || gltf.list("accessors")[static_cast<std::size_t>(accessor)].contains("bufferView");
}

DracoPrimitive checked_draco(const GltfLists& gltf, const Json& primitive, const Json& compressed,
                             const GltfPlace& place) {
  DracoPrimitive result;
  result.indices = index_member(primitive, "indices", gltf.count("accessors"), place);
  if (result.indices < 0) refuse_gltf("has a primitive compressed by Draco without indices", place);
  result.mesh = static_cast<int>(place.index);
  result.view = index_member(compressed, "bufferView", gltf.count("bufferViews"), place);
  if (result.view < 0) refuse_gltf("has no bufferView", place, kDraco);
  if (const Json* attributes = find_object(compressed, "attributes", place)) {
    for (const auto& [name, id] : attributes->items()) {
      result.attributes[name] = checked_index(id, kDraco, std::size_t{1} << 31, place);
    }
  }
  return result;
}

MeshoptView checked_meshopt_view(const GltfLists& gltf, const Json& view, const Json& compressed,
                                 const GltfPlace& place, const char* extension, bool khr) {
  const Json& buffers = gltf.list("buffers");
  const auto number = [&](const char* key) {
    return static_cast<std::size_t>(whole_number(compressed, key, 0, place));
  };
  MeshoptView entry;
  entry.khr = khr;
  entry.view = static_cast<int>(place.index);
  entry.buffer = index_member(compressed, "buffer", buffers.size(), place);
  if (entry.buffer < 0) refuse_gltf("has no buffer", place, extension);
  entry.offset = number("byteOffset");
  entry.size = number("byteLength");
  entry.count = number("count");
  entry.stride = number("byteStride");
  entry.mode = mode_of(compressed, place, extension);
  entry.filter = filter_of(compressed, place, extension, khr);
  const std::size_t length = static_cast<std::size_t>(whole_number(buffers[entry.buffer], "byteLength", 0, place));
  if (entry.offset > length || entry.size > length - entry.offset) {
    refuse_gltf("reaches beyond its buffer", place, extension);
  }
  if (!is_valid_stride(entry))
    refuse_gltf("has a byteStride or count that its mode or filter does not permit", place, extension);
  const std::size_t bytes = entry.count * entry.stride;
  if (bytes > entry.max_ratio() * (entry.size + 1) ||
      bytes != static_cast<std::size_t>(whole_number(view, "byteLength", 0, place))) {
    refuse_gltf(fmt::format("has {} elements, which do not match its byteLength", entry.count), place, extension);
  }
  return entry;
}

}  // namespace

std::vector<MeshoptView> checked_meshopt_views(const GltfLists& gltf) {
  std::vector<MeshoptView> result;
  gltf.each("bufferViews", [&](const Json& view, const GltfPlace& place) {
    for (const bool khr : {false, true}) {
      const char* const extension = khr ? "KHR_meshopt_compression" : "EXT_meshopt_compression";
      const Json* compressed = find_extension(view, extension, place);
      if (!compressed) continue;
      if (!result.empty() && result.back().view == static_cast<int>(place.index))
        refuse_gltf("must not be used together with EXT_meshopt_compression", place, extension);
      result.push_back(checked_meshopt_view(gltf, view, *compressed, place, extension, khr));
    }
  });
  return result;
}

std::vector<DracoPrimitive> checked_draco_primitives(const GltfLists& gltf) {
  std::vector<DracoPrimitive> result;
  gltf.each("meshes", [&](const Json& mesh, const GltfPlace& place) {
    const Json& primitives = mesh.at("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const Json* compressed = find_extension(primitives[i], kDraco, place);
      if (!compressed) continue;
      bool plain = has_buffer_view(gltf, primitives[i], "indices", place);
      for (const auto& [name, accessor] : primitives[i].at("attributes").items()) {
        plain = plain && has_buffer_view(gltf, primitives[i].at("attributes"), name.c_str(), place);
      }
      if (plain) continue;
      result.push_back(checked_draco(gltf, primitives[i], *compressed, place));
      result.back().primitive = static_cast<int>(i);
    }
  });
  return result;
}

}  // namespace patchlight

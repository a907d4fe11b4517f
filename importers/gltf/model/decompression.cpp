#include "importers/gltf/model/decompression.h"

#include <fmt/format.h>

#include <cstring>

#include "importers/gltf/model/accessor.h"
#include "importers/gltf/model/mesh_decoder.h"
#include "pipeline/model/error.h"
#include "pipeline/system/on_demand.h"

namespace patchlight {
namespace {

constexpr const char* kDecoders = "patchlight-meshes";
constexpr std::size_t kMaxDracoReuse = 16;  // compressed bytes of all meshes / bytes of all buffers
constexpr std::size_t kMaxSparseBytes = std::size_t{256} << 20;  // of all sparse accessors, expanded

[[noreturn]] void refuse(const std::string& what, const std::string& place) {
  throw Error(ExitCode::bad_data, what, place, "the file is damaged; export the scene again");
}

/// Adds a buffer and a bufferView of all its bytes. Returns the bufferView's index.
int add_view(GltfModel& model, Bytes bytes) {
  model.owned.push_back(std::make_shared<const Bytes>(std::move(bytes)));
  tinygltf::BufferView view;
  view.buffer = static_cast<int>(model.buffers.size());
  view.byteLength = model.owned.back()->size();
  model.buffers.emplace_back(*model.owned.back());
  model.gltf.bufferViews.push_back(std::move(view));
  return static_cast<int>(model.gltf.bufferViews.size()) - 1;
}

void decompress_view(GltfModel& model, const MeshoptView& compressed) {
  const std::string place = fmt::format("{}, bufferViews[{}]", model.file.name, compressed.view);
  const std::span<const unsigned char> buffer = model.buffers[compressed.buffer];
  if (compressed.offset + compressed.size > buffer.size())
    refuse("the buffer of its compressed bytes has no data", place);
  const int view =
      add_view(model, decompress_meshopt(compressed, buffer.subspan(compressed.offset, compressed.size), place));
  model.gltf.bufferViews[view].byteStride = model.gltf.bufferViews[compressed.view].byteStride;
  model.gltf.bufferViews[compressed.view] = model.gltf.bufferViews[view];
}

/// Adds an accessor like `source` for these bytes. Returns its index.
int add_accessor(GltfModel& model, tinygltf::Accessor source, Bytes bytes) {
  source.bufferView = add_view(model, std::move(bytes));
  source.byteOffset = 0;
  source.sparse.isSparse = false;
  model.gltf.accessors.push_back(std::move(source));
  return static_cast<int>(model.gltf.accessors.size()) - 1;
}

void decompress_primitive(GltfModel& model, const DracoPrimitive& compressed) {
  tinygltf::Mesh& mesh = model.gltf.meshes[compressed.mesh];
  tinygltf::Primitive& primitive = mesh.primitives[compressed.primitive];
  const std::string place = fmt::format("{}, meshes[{}] '{}'", model.file.name, compressed.mesh, mesh.name);
  const bool list = primitive.mode == TINYGLTF_MODE_TRIANGLES;
  if (!list && primitive.mode != TINYGLTF_MODE_TRIANGLE_STRIP)
    refuse("Draco compresses a mesh primitive that is not triangles", place);
  tinygltf::Accessor indices = model.gltf.accessors[compressed.indices];

  DracoMesh decoded;
  if (indices.count < 3) return;
  decoded.triangles = list ? indices.count / 3 : indices.count - 2;
  for (const auto& [name, accessor] : primitive.attributes) {
    const tinygltf::Accessor& source = model.gltf.accessors[accessor];
    const auto id = compressed.attributes.find(name);
    if (id == compressed.attributes.end()) continue;  // not compressed
    DracoAttribute& attribute = decoded.attributes.emplace_back();
    attribute.name = name;
    attribute.id = id->second;
    attribute.component_type = source.componentType;
    attribute.components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(source.type));
  }
  decompress_draco(view_bytes(model, compressed.view), place, decoded);
  for (DracoAttribute& attribute : decoded.attributes) {
    int& accessor = primitive.attributes[attribute.name];
    if (model.gltf.accessors[accessor].count != decoded.vertices) {
      refuse(fmt::format("the Draco data has {} vertices, but the accessor has {}", decoded.vertices,
                         model.gltf.accessors[accessor].count),
             place);
    }
    accessor = add_accessor(model, model.gltf.accessors[accessor], std::move(attribute.bytes));
    if (attribute.rounding > 0.0) model.roundings[accessor] = attribute.rounding;
  }
  indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  indices.count = 3 * decoded.triangles;
  primitive.indices = add_accessor(model, std::move(indices), std::move(decoded.indices));
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
}

/// Refuses files whose compressed parts overlap so much that they expand far beyond the buffers' size.
void check_expansion(const GltfModel& model) {
  std::size_t bytes = 1, meshopt = 0, draco = 0;
  for (const auto& buffer : model.buffers) bytes += buffer.size();
  for (const MeshoptView& view : model.checked.meshopt_views) meshopt += view.count * view.stride / view.max_ratio();
  for (const DracoPrimitive& primitive : model.checked.draco_primitives)
    draco += model.gltf.bufferViews[primitive.view].byteLength;
  if (meshopt > bytes || draco / kMaxDracoReuse > bytes)
    refuse("compressed meshes expand to more than the buffers can contain", model.file.name);
}

/// Expands a sparse accessor. `budget`: bytes that may still be allocated.
void expand_sparse(GltfModel& model, tinygltf::Accessor& accessor, std::size_t& budget) {
  const auto components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  const std::size_t size = size_of(accessor.componentType) * static_cast<std::size_t>(components);
  if (accessor.count > budget / size) {
    throw Error(ExitCode::over_limit, "sparse accessors expand to more than 256 MiB", model.file.name,
                "export without sparse accessors; this limit is fixed");
  }
  budget -= accessor.count * size;
  Bytes bytes(accessor.count * size, 0);
  if (accessor.bufferView >= 0) {
    const tinygltf::BufferView& view = model.gltf.bufferViews[accessor.bufferView];
    const unsigned char* from = view_bytes(model, accessor.bufferView).data() + accessor.byteOffset;
    const std::size_t stride = view.byteStride > 0 ? view.byteStride : size;
    for (std::size_t i = 0; i < accessor.count; ++i) std::memcpy(bytes.data() + i * size, from + i * stride, size);
  }
  const auto& sparse = accessor.sparse;
  const unsigned char* index = view_bytes(model, sparse.indices.bufferView).data() + sparse.indices.byteOffset;
  const unsigned char* value = view_bytes(model, sparse.values.bufferView).data() + sparse.values.byteOffset;
  for (int i = 0; i < sparse.count; ++i, index += size_of(sparse.indices.componentType), value += size) {
    const std::uint32_t element = unsigned_at(index, sparse.indices.componentType);
    if (element >= accessor.count)
      refuse(fmt::format("sparse element {} of {} does not exist", element, accessor.count), model.file.name);
    std::memcpy(bytes.data() + element * size, value, size);
  }
  accessor.bufferView = add_view(model, std::move(bytes));
  accessor.byteOffset = 0;
  accessor.sparse.isSparse = false;
}

}  // namespace

void decompress(GltfModel& model) {
  check_expansion(model);
  for (const MeshoptView& view : model.checked.meshopt_views) decompress_view(model, view);
  std::size_t budget = kMaxSparseBytes;
  for (tinygltf::Accessor& accessor : model.gltf.accessors) {
    if (accessor.sparse.isSparse) expand_sparse(model, accessor, budget);
  }
  for (const DracoPrimitive& primitive : model.checked.draco_primitives) decompress_primitive(model, primitive);
}

Bytes decompress_meshopt(const MeshoptView& view, std::span<const unsigned char> compressed, const std::string& place) {
  static auto* const decode = on_demand<decltype(decode_meshopt)>(kDecoders, "decode_meshopt");
  Bytes elements;
  if (!decode(view, compressed, elements)) refuse("its data, compressed by meshoptimizer, are damaged", place);
  return elements;
}

void decompress_draco(std::span<const unsigned char> compressed, const std::string& place, DracoMesh& mesh) {
  static auto* const decode = on_demand<decltype(decode_draco)>(kDecoders, "decode_draco");
  decode(compressed, place, mesh);
}

}  // namespace patchlight

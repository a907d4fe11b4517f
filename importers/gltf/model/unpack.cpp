#include "importers/gltf/model/unpack.h"

#include <fmt/format.h>

#include <cstring>

#include "importers/gltf/model/accessor.h"
#include "importers/gltf/model/mesh_decoder.h"
#include "pipeline/model/error.h"
#include "pipeline/system/on_demand.h"

namespace patchlight {
namespace {

constexpr const char* kDecoders = "patchlight-meshes";
constexpr std::size_t kMostReuse = 16;                         // of all bytes, by meshes that Draco packs
constexpr std::size_t kMostFilledIn = std::size_t{256} << 20;  // bytes of all sparse accessors

[[noreturn]] void refuse(const std::string& what, const std::string& place) {
  throw Error(ExitCode::bad_data, what, place, "the file is damaged; export the scene again");
}

/// Adds a buffer of bytes without gaps. Returns its bufferView.
int add_view(GltfModel& model, Bytes bytes) {
  model.owned.push_back(std::make_shared<const Bytes>(std::move(bytes)));
  tinygltf::BufferView view;
  view.buffer = static_cast<int>(model.buffers.size());
  view.byteLength = model.owned.back()->size();
  model.buffers.emplace_back(*model.owned.back());
  model.gltf.bufferViews.push_back(std::move(view));
  return static_cast<int>(model.gltf.bufferViews.size()) - 1;
}

void unpack_view(GltfModel& model, const MeshoptView& packed) {
  const std::string place = fmt::format("{}, bufferViews[{}]", model.file.name, packed.view);
  const std::span<const unsigned char> buffer = model.buffers[packed.buffer];
  if (packed.offset + packed.size > buffer.size()) refuse("the buffer of its packed bytes has no data", place);
  const int view = add_view(model, unpack_meshopt(packed, buffer.subspan(packed.offset, packed.size), place));
  model.gltf.bufferViews[view].byteStride = model.gltf.bufferViews[packed.view].byteStride;
  model.gltf.bufferViews[packed.view] = model.gltf.bufferViews[view];
}

/// Adds an accessor like `source` over bytes of its own. Returns its index.
int add_accessor(GltfModel& model, tinygltf::Accessor source, Bytes bytes) {
  source.bufferView = add_view(model, std::move(bytes));
  source.byteOffset = 0;
  source.sparse.isSparse = false;
  model.gltf.accessors.push_back(std::move(source));
  return static_cast<int>(model.gltf.accessors.size()) - 1;
}

void unpack_primitive(GltfModel& model, const DracoPrimitive& packed) {
  tinygltf::Mesh& mesh = model.gltf.meshes[packed.mesh];
  tinygltf::Primitive& primitive = mesh.primitives[packed.primitive];
  const std::string place = fmt::format("{}, meshes[{}] '{}'", model.file.name, packed.mesh, mesh.name);
  const bool list = primitive.mode == TINYGLTF_MODE_TRIANGLES;
  if (!list && primitive.mode != TINYGLTF_MODE_TRIANGLE_STRIP)
    refuse("Draco packs something else than triangles", place);
  tinygltf::Accessor indices = model.gltf.accessors[packed.indices];

  DracoMesh unpacked;
  if (indices.count < 3) return;
  unpacked.triangles = list ? indices.count / 3 : indices.count - 2;
  for (const auto& [name, accessor] : primitive.attributes) {
    const tinygltf::Accessor& source = model.gltf.accessors[accessor];
    const auto id = packed.attributes.find(name);
    if (id == packed.attributes.end()) continue;  // it has bytes of its own, or counts as zeros
    DracoAttribute& attribute = unpacked.attributes.emplace_back();
    attribute.name = name;
    attribute.id = id->second;
    attribute.component_type = source.componentType;
    attribute.components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(source.type));
  }
  unpack_draco(view_bytes(model, packed.view), place, unpacked);
  for (DracoAttribute& attribute : unpacked.attributes) {
    int& accessor = primitive.attributes[attribute.name];
    if (model.gltf.accessors[accessor].count != unpacked.vertices) {
      refuse(fmt::format("Draco packs {} vertices where {} are stated", unpacked.vertices,
                         model.gltf.accessors[accessor].count),
             place);
    }
    accessor = add_accessor(model, model.gltf.accessors[accessor], std::move(attribute.bytes));
    if (attribute.rounding > 0.0) model.roundings[accessor] = attribute.rounding;
  }
  indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  indices.count = 3 * unpacked.triangles;
  primitive.indices = add_accessor(model, std::move(indices), std::move(unpacked.indices));
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
}

/// Packed parts that stand for more than their buffers can hold are not worth unpacking.
void check_sizes(const GltfModel& model) {
  std::size_t bytes = 1, elements = 0, packed = 0;
  for (const auto& buffer : model.buffers) bytes += buffer.size();
  for (const MeshoptView& view : model.checked.meshopt_views) elements += view.count * view.stride;
  for (const DracoPrimitive& primitive : model.checked.draco_primitives)
    packed += model.gltf.bufferViews[primitive.view].byteLength;
  if (elements / kMostMeshoptGain > bytes || packed / kMostReuse > bytes)
    refuse("packed meshes stand for more than the buffers can hold", model.file.name);
}

/// Gives a sparse accessor plain bytes.
void fill_in(GltfModel& model, tinygltf::Accessor& accessor, std::size_t& budget) {
  const auto components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  const std::size_t size = size_of(accessor.componentType) * static_cast<std::size_t>(components);
  if (accessor.count > budget / size) {
    throw Error(ExitCode::over_limit, "sparse accessors take more than 256 MiB", model.file.name,
                "export without them; this limit is fixed");
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

void unpack(GltfModel& model) {
  check_sizes(model);
  for (const MeshoptView& view : model.checked.meshopt_views) unpack_view(model, view);
  std::size_t budget = kMostFilledIn;
  for (tinygltf::Accessor& accessor : model.gltf.accessors) {
    if (accessor.sparse.isSparse) fill_in(model, accessor, budget);
  }
  for (const DracoPrimitive& primitive : model.checked.draco_primitives) unpack_primitive(model, primitive);
}

Bytes unpack_meshopt(const MeshoptView& view, std::span<const unsigned char> packed, const std::string& place) {
  static auto* const decode = on_demand<decltype(decode_meshopt)>(kDecoders, "decode_meshopt");
  Bytes elements;
  if (!decode(view, packed, elements)) refuse("what EXT_meshopt_compression packs cannot be unpacked", place);
  return elements;
}

void unpack_draco(std::span<const unsigned char> packed, const std::string& place, DracoMesh& mesh) {
  static auto* const decode = on_demand<decltype(decode_draco)>(kDecoders, "decode_draco");
  decode(packed, place, mesh);
}

}  // namespace patchlight

#include "importers/gltf_unpack.h"

#include <fmt/format.h>

#include "importers/mesh_decoder.h"
#include "pipeline/files/on_demand.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr const char* kDecoders = "patchlight-meshes";

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

}  // namespace

void unpack(GltfModel& model) {
  for (const MeshoptView& view : model.checked.meshopt_views) unpack_view(model, view);
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

#pragma once
#include <meshoptimizer.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/importers/draco_packer.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {

/// Appends bytes to the scene's buffer, aligned to 4. Returns the JSON of their bufferView.
inline Json appended(GltfBuilder& gltf, const void* bytes, std::size_t size) {
  while (gltf.binary.size() % 4 != 0) gltf.binary += '\0';
  Json view = {{"buffer", 0}, {"byteOffset", gltf.binary.size()}, {"byteLength", size}};
  gltf.binary.append(static_cast<const char*>(bytes), size);
  return view;
}

inline int add(Json& list, const Json& item) {
  list.push_back(item);
  return int(list.size()) - 1;
}

/// Positions quantized to unsigned shorts, padded to 8 bytes each, and the node transform that restores them.
struct QuantizedPositions {
  std::vector<std::uint16_t> values;
  float low = 0.0f, step = 1.0f;

  explicit QuantizedPositions(const Mesh& mesh, int bits = 14) {
    float high = -1e30f;
    low = 1e30f;
    for (const Vec3f& p : mesh.positions)
      for (int i = 0; i < 3; ++i) low = std::min(low, p[i]), high = std::max(high, p[i]);
    step = (high - low) / float((1 << bits) - 1);
    for (const Vec3f& p : mesh.positions) {
      for (int i = 0; i < 3; ++i) values.push_back(std::uint16_t(std::lround((p[i] - low) / step)));
      values.push_back(0);
    }
  }

  /// The node with the transform that restores the positions.
  Json with_transform(Json node) const {
    node["translation"] = {low, low, low};
    node["scale"] = {step, step, step};
    return node;
  }
};

/// A mesh with quantized positions. `meshopt`: positions and indices are compressed.
inline int quantized_mesh(GltfBuilder& gltf, const Mesh& mesh, const QuantizedPositions& positions, bool meshopt,
                          int material = -1) {
  Json& used = gltf.json["extensionsRequired"];
  for (const char* name : {"KHR_mesh_quantization", "EXT_meshopt_compression"})
    if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
  const std::size_t vertices = mesh.positions.size();
  Json vertex_view, index_view;
  if (meshopt) {
    std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(vertices, 8));
    packed.resize(
        meshopt_encodeVertexBuffer(packed.data(), packed.size(), positions.values.data(), vertices, std::size_t{8}));
    const auto extended = [&](Json view, std::size_t count, std::size_t stride, const char* mode) {
      Json extension = view;
      extension.update({{"count", count}, {"byteStride", stride}, {"mode", mode}});
      view = {{"buffer", 0}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", extension}}}};
      return view;
    };
    vertex_view = extended(appended(gltf, packed.data(), packed.size()), vertices, 8, "ATTRIBUTES");
    std::vector<unsigned char> indices(meshopt_encodeIndexBufferBound(mesh.indices.size(), vertices));
    indices.resize(meshopt_encodeIndexBuffer(indices.data(), indices.size(), mesh.indices.data(), mesh.indices.size()));
    index_view = extended(appended(gltf, indices.data(), indices.size()), mesh.indices.size(), 4, "TRIANGLES");
    // Both bufferViews are larger uncompressed than the scene's buffer: they refer to a placeholder buffer.
    for (Json* view : {&vertex_view, &index_view}) (*view)["buffer"] = 1;
    gltf.json["buffers"] = {{{"byteLength", 0}}, {{"byteLength", std::size_t{1} << 24}}};
  } else {
    vertex_view = appended(gltf, positions.values.data(), positions.values.size() * 2);
    index_view = appended(gltf, mesh.indices.data(), mesh.indices.size() * 4);
  }
  vertex_view["byteStride"] = 8;
  const int vertex_accessor = add(gltf.json["accessors"], {{"bufferView", add(gltf.json["bufferViews"], vertex_view)},
                                                           {"componentType", 5123},
                                                           {"count", vertices},
                                                           {"type", "VEC3"}});
  const int index_accessor = add(gltf.json["accessors"], {{"bufferView", add(gltf.json["bufferViews"], index_view)},
                                                          {"componentType", 5125},
                                                          {"count", mesh.indices.size()},
                                                          {"type", "SCALAR"}});
  Json primitive = {{"attributes", {{"POSITION", vertex_accessor}}}, {"indices", index_accessor}};
  if (material >= 0) primitive["material"] = material;
  if (meshopt) gltf.json["buffers"][0]["byteLength"] = gltf.binary.size();
  return add(gltf.json["meshes"], {{"primitives", {primitive}}});
}

/// A mesh whose positions and indices are compressed by Draco.
inline int draco_mesh(GltfBuilder& gltf, const Mesh& mesh, int bits, int material = -1) {
  gltf.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const DracoBytes packed = draco_packed(mesh.positions, mesh.indices, bits);
  const int view = add(gltf.json["bufferViews"], appended(gltf, packed.bytes.data(), packed.bytes.size()));
  const int positions =
      add(gltf.json["accessors"], {{"componentType", 5126}, {"count", packed.vertices}, {"type", "VEC3"}});
  const int indices =
      add(gltf.json["accessors"], {{"componentType", 5125}, {"count", mesh.indices.size()}, {"type", "SCALAR"}});
  Json primitive = {
      {"attributes", {{"POSITION", positions}}},
      {"indices", indices},
      {"extensions", {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", {{"POSITION", 0}}}}}}}};
  if (material >= 0) primitive["material"] = material;
  return add(gltf.json["meshes"], {{"primitives", {primitive}}});
}

}  // namespace patchlight::test

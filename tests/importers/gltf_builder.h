#pragma once
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "importers/import.h"
#include "tests/importers/mesh/mesh_shapes.h"
#include "tests/temporary_folder.h"

namespace patchlight::test {

using Json = nlohmann::json;

/// Builds a glTF scene. Tests may modify `json` before it is written.
struct GltfBuilder {
  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  std::string binary;

  template <class T>
  int accessor(const std::vector<T>& values, int component_type, const std::string& type) {
    while (binary.size() % 4 != 0) binary += '\0';
    const std::size_t size = values.size() * sizeof(T);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", size}});
    binary.append(reinterpret_cast<const char*>(values.data()), size);
    const int view = int(json["bufferViews"].size()) - 1;
    json["accessors"].push_back(
        {{"bufferView", view}, {"componentType", component_type}, {"count", values.size()}, {"type", type}});
    return int(json["accessors"].size()) - 1;
  }

  int mesh(const Mesh& source, int material = -1) {
    Json primitive = {{"attributes", {{"POSITION", accessor(source.positions, 5126, "VEC3")}}}};
    if (!source.normals.empty()) primitive["attributes"]["NORMAL"] = accessor(source.normals, 5126, "VEC3");
    if (!source.indices.empty()) primitive["indices"] = accessor(source.indices, 5125, "SCALAR");
    if (material >= 0) primitive["material"] = material;
    json["meshes"].push_back({{"primitives", {primitive}}});
    return int(json["meshes"].size()) - 1;
  }

  /// A material without a coat, unless the source says what its coat is.
  int material(const Json& source) {
    json["materials"].push_back(source);
    Json& extensions = json["materials"].back()["extensions"];
    if (!extensions.contains("KHR_materials_specular")) extensions["KHR_materials_specular"] = {{"specularFactor", 0}};
    return int(json["materials"].size()) - 1;
  }

  /// A root node.
  int node(const Json& source) {
    json["nodes"].push_back(source);
    const int index = int(json["nodes"].size()) - 1;
    json["scenes"][0]["nodes"].push_back(index);
    return index;
  }

  Json& primitive(int mesh_index) { return json["meshes"][mesh_index]["primitives"][0]; }

  std::string glb() {
    if (!binary.empty() && !json.contains("buffers")) json["buffers"] = {{{"byteLength", binary.size()}}};
    std::string text = json.dump();
    while (text.size() % 4 != 0) text += ' ';
    std::string chunk = binary;
    while (chunk.size() % 4 != 0) chunk += '\0';
    const auto word = [](std::size_t value) {
      const auto narrow = std::uint32_t(value);
      std::string bytes(4, '\0');
      std::memcpy(bytes.data(), &narrow, 4);
      return bytes;
    };
    std::string body = word(text.size()) + "JSON" + text;
    if (!chunk.empty()) body += word(chunk.size()) + std::string("BIN\0", 4) + chunk;
    return "glTF" + word(2) + word(12 + body.size()) + body;
  }
};

/// Imports files from a temporary folder and records the messages to the user.
struct Importer {
  TemporaryFolder folder;
  Job job;

  PatchSet import_file(const std::filesystem::path& file) {
    job.scene = file;
    Progress progress({.stage = "import", .quiet = true, .log_json_file = (folder / "log.json").string()});
    return import_scene(job, progress);
  }
  PatchSet import_bytes(const std::string& bytes) { return import_file(folder.write("scene.glb", bytes)); }
  PatchSet import(GltfBuilder& gltf) { return import_bytes(gltf.glb()); }
  std::string messages() const { return read_text(folder / "log.json"); }
};

/// A scene with one mesh on one node.
inline GltfBuilder single_mesh(const Mesh& mesh, const Json& material = nullptr, Json node = Json::object()) {
  GltfBuilder gltf;
  node["mesh"] = gltf.mesh(mesh, material.is_null() ? -1 : gltf.material(material));
  gltf.node(node);
  return gltf;
}

inline double total_area(const PatchSet& scene) {
  double area = 0.0;
  for (const Patch& patch : scene.patches) area += patch.area;
  return area;
}

/// Unit normal of a quad.
inline Vec3d facing(const Primitive& quad) {
  const auto& c = quad.corners;
  return (c[2] - c[0]).cross(c[3] - c[1]).normalized();
}

}  // namespace patchlight::test

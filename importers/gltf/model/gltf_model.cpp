#include "importers/gltf/model/gltf_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "importers/gltf/model/decompression.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

tinygltf::Model parsed_model(const std::string& json, const std::string& file) {
  tinygltf::TinyGLTF parser;
  // The reduced JSON contains no URI of a file or an image. These callbacks make sure that none is ever opened.
  parser.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                           void*) { return true; },
                        nullptr);
  parser.SetFsCallbacks(
      {[](const std::string&, void*) { return false; }, [](const std::string& path, void*) { return path; },
       [](std::vector<unsigned char>*, std::string*, const std::string&, void*) { return false; },
       [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }, nullptr});
  tinygltf::Model model;
  std::string error;
  std::string warning;
  if (!parser.LoadASCIIFromString(&model, &error, &warning, json.data(), static_cast<unsigned int>(json.size()), "",
                                  0)) {
    throw Error(ExitCode::bad_data, "not glTF: " + error, file, "export the scene again");
  }
  return model;
}

void load_buffers(GltfModel& model) {
  for (std::size_t i = 0; i < model.checked.buffers.size(); ++i) {
    const GltfData& buffer = model.checked.buffers[i];
    std::span<const unsigned char> bytes;
    if (!buffer.uri.empty()) {
      model.owned.push_back(read_uri(model.file, buffer.uri, buffer.name));
      bytes = *model.owned.back();
    } else if (i == 0 && model.file.has_binary_chunk) {
      bytes = model.file.binary_chunk;
    } else {
      model.buffers.emplace_back();  // a placeholder whose data comes from extensions; reading it is an error
      continue;
    }
    if (bytes.size() < buffer.size) {
      throw Error(
          ExitCode::bad_data,
          fmt::format("the buffer has a byteLength of {}, but only {} bytes of data", buffer.size, bytes.size()),
          model.file.name + ", " + buffer.name, "the file is truncated; export or copy it again");
    }
    model.buffers.push_back(bytes.first(buffer.size));
  }
}

std::int64_t triangle_count(const tinygltf::Model& gltf, const tinygltf::Primitive& primitive) {
  const auto positions = primitive.attributes.find("POSITION");
  if (positions == primitive.attributes.end()) return 0;
  const tinygltf::Accessor& accessor = gltf.accessors[positions->second];
  if (accessor.bufferView < 0 && !accessor.sparse.isSparse) return 0;  // all positions are zero
  const int source = primitive.indices >= 0 ? primitive.indices : positions->second;
  const auto count = static_cast<std::int64_t>(gltf.accessors[source].count);
  switch (primitive.mode) {
    case TINYGLTF_MODE_TRIANGLES:
      return count / 3;
    case TINYGLTF_MODE_TRIANGLE_STRIP:
    case TINYGLTF_MODE_TRIANGLE_FAN:
      return std::max<std::int64_t>(count - 2, 0);
    default:
      return 0;
  }
}

std::vector<MeshPart> parts_of(const tinygltf::Model& gltf, const tinygltf::Mesh& mesh) {
  std::vector<MeshPart> parts;
  std::map<int, std::size_t> part_of_material;
  for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
    const tinygltf::Primitive& primitive = mesh.primitives[i];
    const std::int64_t triangles = triangle_count(gltf, primitive);
    if (triangles == 0) continue;
    const auto [entry, is_new] = part_of_material.emplace(primitive.material, parts.size());
    if (is_new) parts.push_back({primitive.material, {}});
    MeshPart& part = parts[entry->second];
    part.primitives.push_back(static_cast<int>(i));
    part.triangles += triangles;
    const auto color = primitive.attributes.find("COLOR_0");
    if (color == primitive.attributes.end()) continue;
    part.has_colors = true;
    part.has_alphas = part.has_alphas || gltf.accessors[color->second].type == TINYGLTF_TYPE_VEC4;
  }
  return parts;
}

void report_skipped_primitives(GltfModel& model) {
  bool lines = false;
  bool without_positions = false;
  for (const tinygltf::Mesh& mesh : model.gltf.meshes) {
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      lines = lines || primitive.mode < TINYGLTF_MODE_TRIANGLES;
      without_positions = without_positions || !primitive.attributes.contains("POSITION");
    }
  }
  if (lines) model.checked.ignored.push_back("points and lines are skipped: they have no area");
  if (without_positions) model.checked.ignored.push_back("mesh primitives without positions are skipped");
}

}  // namespace

GltfModel load_gltf_model(GltfFile file, const GltfReadOptions& options) {
  GltfModel model;
  model.file = std::move(file);
  model.checked = check_gltf(model.file.json, model.file.name, options);
  model.gltf = parsed_model(model.checked.json, model.file.name);
  model.checked.json.clear();
  load_buffers(model);
  decompress(model);
  for (const tinygltf::Mesh& mesh : model.gltf.meshes) model.mesh_parts.push_back(parts_of(model.gltf, mesh));
  report_skipped_primitives(model);
  return model;
}

std::span<const unsigned char> view_bytes(const GltfModel& model, int view) {
  const tinygltf::BufferView& source = model.gltf.bufferViews[view];
  if (source.byteOffset + source.byteLength > model.buffers[source.buffer].size()) {
    throw Error(ExitCode::bad_data, "the buffer has no data",
                model.file.name + ", " + model.checked.buffers[source.buffer].name, "export the scene again");
  }
  return model.buffers[source.buffer].subspan(source.byteOffset, source.byteLength);
}

std::span<const unsigned char> image_bytes(GltfModel& model, int image, std::shared_ptr<const Bytes>& owner) {
  const GltfData& data = model.checked.images[image];
  if (data.uri.empty())
    return data.buffer_view < 0 ? std::span<const unsigned char>() : view_bytes(model, data.buffer_view);
  owner = read_uri(model.file, data.uri, data.name);
  return *owner;
}

}  // namespace patchlight

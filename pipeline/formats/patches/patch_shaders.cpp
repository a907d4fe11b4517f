#include "pipeline/formats/patches/patch_shaders.h"

#include <algorithm>

namespace patchlight {

namespace {

std::vector<std::string> flat(const std::vector<Shader>& shaders, ColorExpressions Shader::*color) {
  std::vector<std::string> values;
  for (const Shader& shader : shaders) values.insert(values.end(), (shader.*color).begin(), (shader.*color).end());
  return values;
}

void read_flat(const H5Reader& reader, const std::string& name, std::vector<Shader>& shaders,
               ColorExpressions Shader::*color) {
  const std::vector<std::string> values = reader.strings(name, std::int64_t(3 * shaders.size()));
  for (std::size_t i = 0; i < shaders.size(); ++i) std::copy_n(values.begin() + 3 * i, 3, (shaders[i].*color).begin());
}

}  // namespace

void write_shader_datasets(H5Writer& writer, const PatchSet& scene) {
  if (scene.shaders.empty()) return;
  std::vector<std::string> names;
  for (const Shader& shader : scene.shaders) names.push_back(shader.name);
  writer.strings("/shaders/name", names);
  writer.strings("/shaders/reflectance", flat(scene.shaders, &Shader::reflectance));
  writer.strings("/shaders/emission", flat(scene.shaders, &Shader::emission));
  std::vector<std::int32_t> assigned;
  for (const Primitive& p : scene.primitives) assigned.push_back(p.shader);
  writer.dataset<std::int32_t>("/primitives/shader", assigned);
}

void read_shader_datasets(const H5Reader& reader, PatchSet& scene) {
  if (!reader.has("/shaders/name")) return;
  for (const auto& name : reader.strings("/shaders/name", -1)) scene.shaders.push_back({name, {}, {}});
  read_flat(reader, "/shaders/reflectance", scene.shaders, &Shader::reflectance);
  read_flat(reader, "/shaders/emission", scene.shaders, &Shader::emission);
  const auto count = std::int64_t(scene.primitives.size());
  const std::vector<std::int32_t> assigned = reader.dataset<std::int32_t>("/primitives/shader", count);
  for (std::size_t i = 0; i < assigned.size(); ++i) scene.primitives[i].shader = assigned[i];
}

}  // namespace patchlight

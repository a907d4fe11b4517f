#include "importers/gltf/read/shader_assignment.h"

#include <fmt/format.h>

#include "importers/gltf/read/name_pattern.h"
#include "pipeline/job/expression.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

/// Compiles a colour's expressions. Returns whether one of them uses u or v. `key`: such as shaders.NAME.reflectance.
bool check_color(const ColorExpressions& color, const Job& job, const std::string& key) {
  if (!is_set(color)) return false;
  bool uses_uv = false;
  for (const std::string& text : color) {
    try {
      uses_uv = Expression(text).reads_uv() || uses_uv;
    } catch (const ExpressionFault& fault) {
      throw Error(ExitCode::bad_config,
                  fmt::format("bad expression `{}` at character {}", text.substr(0, 200), fault.character),
                  fmt::format("{}, {}", job.file.string(), key), fault.reason);
    }
  }
  return uses_uv;
}

}  // namespace

std::vector<char> check_shaders(const Job& job) {
  std::vector<char> uses_uv;
  for (const Shader& shader : job.shaders) {
    const bool reflectance = check_color(shader.reflectance, job, fmt::format("shaders.{}.reflectance", shader.name));
    const bool emission = check_color(shader.emission, job, fmt::format("shaders.{}.emission", shader.name));
    uses_uv.push_back(reflectance || emission);
  }
  return uses_uv;
}

void assign_shaders(const Job& job, const std::vector<char>& uses_uv, GltfScene& scene, Progress& progress) {
  std::vector<int> number(job.shaders.size(), -1);
  for (std::size_t i = 0; i < job.shaders.size(); ++i) {
    const std::string& pattern = job.shaders[i].name;
    bool found = false;
    for (Surface& surface : scene.surfaces) {
      if (!matches(pattern, scene.materials[surface.material].name) && !matches(pattern, scene.nodes[surface.node]))
        continue;
      surface.shader = static_cast<int>(i);
      found = true;
    }
    if (!found)
      progress.warning(fmt::format("shaders.{} in the job matches no material and no node of the scene", pattern));
  }
  for (Surface& surface : scene.surfaces) {
    if (surface.shader < 0) continue;
    surface.needs_texcoords = surface.needs_texcoords || uses_uv[surface.shader] != 0;
    int& index = number[surface.shader];
    if (index < 0) {
      index = static_cast<int>(scene.shaders.size());
      scene.shaders.push_back(job.shaders[surface.shader]);
    }
    surface.shader = index;
  }
}

}  // namespace patchlight

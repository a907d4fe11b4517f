#include "pipeline/optics/surface/material_shader.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/surface/texture_lookup.h"

namespace patchlight {

namespace {

std::vector<Expression> compile(const ColorExpressions& source) {
  std::vector<Expression> color;
  if (!is_set(source)) return color;
  const bool grey = source[1] == source[0] && source[2] == source[0];
  for (std::size_t k = 0; k < (grey ? 1 : 3); ++k) color.emplace_back(source[k]);
  return color;
}

}  // namespace

ExpressionInputs shader_inputs(const PatchSet& scene, std::int32_t i, double u, double v) {
  const SurfacePoint point = point_at(scene.primitives[i], u, v);
  const Imath::V2d at = texcoord_at(scene, i, u, v);
  return {at.x, at.y, point.position, Vec3d(point.normal)};
}

MaterialShader::MaterialShader(const Shader& source)
    : reflectance_(compile(source.reflectance)), emission_(compile(source.emission)) {}

Vec3d MaterialShader::evaluate(std::vector<Expression>& color, const ExpressionInputs& at) {
  if (color.empty()) return Vec3d(0.0);
  const double red = color[0](at);
  return color.size() == 1 ? Vec3d(red) : Vec3d(red, color[1](at), color[2](at));
}

std::vector<MaterialShader> compile_shaders(const PatchSet& scene) {
  std::vector<MaterialShader> shaders;
  for (const Shader& source : scene.shaders) shaders.emplace_back(source);
  return shaders;
}

Color max_diffuse_reflectance(const Material& material) {
  Color highest;
  for (int k = 0; k < 3; ++k)
    highest[k] = std::clamp(1.0f - material.specular[k] - material.translucence[k], 0.0f, kMaxReflectance);
  return highest;
}

Color clamp_color(const Vec3d& value, const Color& highest) {
  Color result;
  for (int k = 0; k < 3; ++k)
    result[k] = std::isfinite(value[k]) ? float(std::clamp(value[k], 0.0, double(highest[k]))) : 0.0f;
  return result;
}

Color shaded_reflectance(const PatchSet& scene, MaterialShader& shader, std::int32_t i, double u, double v) {
  return clamp_color(shader.reflectance(shader_inputs(scene, i, u, v)),
                     max_diffuse_reflectance(scene.materials[scene.primitives[i].material]));
}

}  // namespace patchlight

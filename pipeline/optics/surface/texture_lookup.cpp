#include "pipeline/optics/surface/texture_lookup.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/optics/surface/material_shader.h"

namespace patchlight {

namespace {

/// Indices of the texels `from` and `from` + 1 along an axis of `count` texels. `from` is in the first period or just
/// before it.
std::array<std::int64_t, 2> texel_pair(std::int64_t from, std::int64_t count, Texture::Wrap wrap) {
  const auto wrapped = [&](std::int64_t k) {
    if (wrap == Texture::Wrap::clamp) return std::clamp<std::int64_t>(k, 0, count - 1);
    const std::int64_t period = wrap == Texture::Wrap::mirror ? 2 * count : count;
    k += k < 0 ? period : k >= period ? -period : 0;
    return k < count ? k : period - 1 - k;
  };
  return {wrapped(from), wrapped(from + 1)};
}

/// A texture coordinate, mapped to the first period of the wrap mode.
double in_first_period(double x, Texture::Wrap wrap) {
  if (wrap == Texture::Wrap::clamp) return std::clamp(x, -1.0, 2.0);
  return wrap == Texture::Wrap::mirror ? x - 2 * std::floor(0.5 * x) : x - std::floor(x);
}

/// sRGB in [0,255] to linear in [0,1], by a table with an error below 1e-5.
float srgb_to_linear(float srgb) {
  constexpr int kSteps = 1024;
  static const std::vector<float> table = [] {
    std::vector<float> values(kSteps + 2);
    for (int i = 0; i < kSteps + 2; ++i) {
      const double x = double(i) / kSteps;
      values[i] = float(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
    }
    return values;
  }();
  const float x = srgb * (float(kSteps) / 255.0f);
  const int k = int(x);
  return table[k] + (table[k + 1] - table[k]) * (x - float(k));
}

Vec3f srgb_channels(std::int32_t rgb) {
  return {float(rgb >> 16 & 255), float(rgb >> 8 & 255), float(rgb & 255)};
}

/// decode(texel) at texture coordinates, by the texture's filter.
template <class Decode>
auto filtered_value(const Texture& texture, const Imath::V2d& at, const Decode& decode) {
  constexpr double kMaxPeriods = 1e9;  // beyond, a double has no useful fraction
  const double texel_center = texture.nearest ? 0.0 : 0.5;
  const auto texels = [&](double coordinate, std::int32_t count, Texture::Wrap wrap) {
    return in_first_period(std::clamp(coordinate, -kMaxPeriods, kMaxPeriods), wrap) * count - texel_center;
  };
  const double s = texels(at.x, texture.width, texture.wrap[0]), t = texels(at.y, texture.height, texture.wrap[1]);
  const double left = std::floor(s), top = std::floor(t);
  const auto x = texel_pair(std::int64_t(left), texture.width, texture.wrap[0]);
  const auto y = texel_pair(std::int64_t(top), texture.height, texture.wrap[1]);
  const auto value = [&](int i, int j) { return decode(texture.texels[std::size_t(y[j] * texture.width + x[i])]); };
  auto sum = value(0, 0);
  if (!texture.nearest) {
    const auto a = float(s - left), b = float(t - top);
    sum = (sum * (1 - a) + value(1, 0) * a) * (1 - b) + (value(0, 1) * (1 - a) + value(1, 1) * a) * b;
  }
  return sum;
}

Imath::V2d texcoord_of(const std::vector<Texcoords>& texcoords, std::int32_t i, double u, double v) {
  if (texcoords.empty()) return {u, v};
  const Texcoords& t = texcoords[i];
  const auto bilinear = [&](float Vec2f::*axis) {
    return (t[0].*axis * (1 - u) + t[1].*axis * u) * (1 - v) + (t[3].*axis * (1 - u) + t[2].*axis * u) * v;
  };
  return {bilinear(&Vec2f::x), bilinear(&Vec2f::y)};
}

}  // namespace

Imath::V2d texcoord_at(const PatchSet& scene, std::int32_t i, double u, double v) {
  return texcoord_of(scene.texcoords, i, u, v);
}

Color texture_color(const Texture& texture, const Imath::V2d& at) {
  const Vec3f color = filtered_value(texture, at, srgb_channels);
  return {srgb_to_linear(color.x), srgb_to_linear(color.y), srgb_to_linear(color.z)};
}

Vec2f roughness_metalness(const PatchSet& scene, std::int32_t i, double u, double v) {
  const auto& texcoords =
      scene.metallic_roughness_texcoords.empty() ? scene.texcoords : scene.metallic_roughness_texcoords;
  return filtered_value(scene.textures[scene.primitives[i].metallic_roughness_texture], texcoord_of(texcoords, i, u, v),
                        [](std::int32_t rgb) { return Vec2f(float(rgb >> 8 & 255), float(rgb & 255)); }) /
         255.0f;
}

const Texcoords& normal_texcoords(const PatchSet& scene, std::int32_t i) {
  const auto& texcoords = scene.normal_texcoords.empty() ? scene.texcoords : scene.normal_texcoords;
  return texcoords.empty() ? kIdentityTexcoords : texcoords[i];
}

Vec3f tangent_space_normal(const PatchSet& scene, std::int32_t i, double u, double v) {
  const auto& texcoords = scene.normal_texcoords.empty() ? scene.texcoords : scene.normal_texcoords;
  const Texture& texture = scene.textures[scene.primitives[i].normal_texture];
  return filtered_value(texture, texcoord_of(texcoords, i, u, v), srgb_channels) * (2.0f / 255.0f) - Vec3f(1.0f);
}

Color base_color(const PatchSet& scene, std::int32_t i, double u, double v) {
  const Primitive& primitive = scene.primitives[i];
  const Vec4f vertex = vertex_color(scene, i, u, v);
  const Color color(vertex.x, vertex.y, vertex.z);
  if (primitive.texture < 0) return color;
  return texture_color(scene.textures[primitive.texture], texcoord_at(scene, i, u, v)) * color;
}

Color colored_reflectance(const PatchSet& scene, std::int32_t i, double u, double v) {
  const Primitive& primitive = scene.primitives[i];
  const Material& material = scene.materials[primitive.material];
  Color tint = material.tint;
  if (primitive.metallic_roughness_texture >= 0)
    tint += material.metal * (1.0f - roughness_metalness(scene, i, u, v).y);
  const Color color = tint * base_color(scene, i, u, v);
  Color highest(kMaxReflectance);
  if (!has_varying_metal(scene, i)) highest = max_diffuse_reflectance(material);
  return clamp_color(Vec3d(color.x, color.y, color.z), highest);
}

Color textured_emission(const PatchSet& scene, std::int32_t i, double u, double v) {
  const Primitive& primitive = scene.primitives[i];
  const auto& texcoords = scene.emission_texcoords.empty() ? scene.texcoords : scene.emission_texcoords;
  return scene.materials[primitive.material].emission_tint *
         texture_color(scene.textures[primitive.emission_texture], texcoord_of(texcoords, i, u, v));
}

float mask_value(const Texture& mask, const Imath::V2d& at) {
  return filtered_value(mask, at, [](std::int32_t alpha) { return float(alpha); }) / 255.0f;
}

Vec4f vertex_color(const PatchSet& scene, std::int32_t i, double u, double v) {
  if (scene.colors.empty()) return Vec4f(1.0f);
  const CornerColors& c = scene.colors[i];
  const auto s = float(u), t = float(v);
  return (c[0] * (1 - s) + c[1] * s) * (1 - t) + (c[3] * (1 - s) + c[2] * s) * t;
}

}  // namespace patchlight

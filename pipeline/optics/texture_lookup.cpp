#include "pipeline/optics/texture_lookup.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/material_shader.h"

namespace patchlight {

namespace {

std::int64_t wrapped(std::int64_t k, std::int64_t count, Texture::Wrap wrap) {
  if (wrap == Texture::Wrap::clamp) return std::clamp<std::int64_t>(k, 0, count - 1);
  const std::int64_t period = wrap == Texture::Wrap::mirror ? 2 * count : count;
  k = (k % period + period) % period;
  return k < count ? k : period - 1 - k;
}

/// sRGB from [0, 255] to linear [0, 1] by a table; its error is below 1e-5.
float linear_of(float encoded) {
  constexpr int kSteps = 1024;
  static const std::vector<float> table = [] {
    std::vector<float> values(kSteps + 2);
    for (int i = 0; i < kSteps + 2; ++i) {
      const double x = double(i) / kSteps;
      values[i] = float(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
    }
    return values;
  }();
  const float x = encoded * (float(kSteps) / 255.0f);
  const int k = int(x);
  return table[k] + (table[k + 1] - table[k]) * (x - float(k));
}

Vec3f encoded(const Texture& texture, std::int64_t x, std::int64_t y) {
  const std::int32_t rgb = texture.texels[std::size_t(wrapped(y, texture.height, texture.wrap[1]) * texture.width +
                                                      wrapped(x, texture.width, texture.wrap[0]))];
  return {float(rgb >> 16 & 255), float(rgb >> 8 & 255), float(rgb & 255)};
}

}  // namespace

Imath::V2d texcoord_at(const PatchSet& scene, std::int32_t i, double u, double v) {
  if (scene.texcoords.empty()) return {u, v};
  const Texcoords& t = scene.texcoords[i];
  const auto bilinear = [&](float Vec2f::*axis) {
    return (t[0].*axis * (1 - u) + t[1].*axis * u) * (1 - v) + (t[3].*axis * (1 - u) + t[2].*axis * u) * v;
  };
  return {bilinear(&Vec2f::x), bilinear(&Vec2f::y)};
}

Color texture_color(const Texture& texture, const Imath::V2d& at) {
  constexpr double kFarthest = 1e9;  // turns of a texture that still have digits
  const double s = std::clamp(at.x, -kFarthest, kFarthest) * texture.width - (texture.nearest ? 0.0 : 0.5);
  const double t = std::clamp(at.y, -kFarthest, kFarthest) * texture.height - (texture.nearest ? 0.0 : 0.5);
  const auto x = std::int64_t(std::floor(s)), y = std::int64_t(std::floor(t));
  Vec3f color = encoded(texture, x, y);
  if (!texture.nearest) {
    const auto a = float(s - double(x)), b = float(t - double(y));
    color = (color * (1 - a) + encoded(texture, x + 1, y) * a) * (1 - b) +
            (encoded(texture, x, y + 1) * (1 - a) + encoded(texture, x + 1, y + 1) * a) * b;
  }
  return {linear_of(color.x), linear_of(color.y), linear_of(color.z)};
}

Color textured_reflectance(const PatchSet& scene, std::int32_t i, double u, double v) {
  const Primitive& primitive = scene.primitives[i];
  const Material& material = scene.materials[primitive.material];
  const Color color = material.tint * texture_color(scene.textures[primitive.texture], texcoord_at(scene, i, u, v));
  return within_range(Vec3d(color.x, color.y, color.z), most_reflectance(material));
}

}  // namespace patchlight

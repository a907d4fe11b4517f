#include "pipeline/optics/texture_lookup.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/optics/material_shader.h"

namespace patchlight {

namespace {

/// Where texels `from` and after it lie along an axis of `count` texels; `from` is in the first period or just before.
std::array<std::int64_t, 2> texel_pair(std::int64_t from, std::int64_t count, Texture::Wrap wrap) {
  const auto wrapped = [&](std::int64_t k) {
    if (wrap == Texture::Wrap::clamp) return std::clamp<std::int64_t>(k, 0, count - 1);
    const std::int64_t period = wrap == Texture::Wrap::mirror ? 2 * count : count;
    k += k < 0 ? period : k >= period ? -period : 0;
    return k < count ? k : period - 1 - k;
  };
  return {wrapped(from), wrapped(from + 1)};
}

/// A texture coordinate in its wrapping's first period.
double in_first_period(double x, Texture::Wrap wrap) {
  if (wrap == Texture::Wrap::clamp) return std::clamp(x, -1.0, 2.0);
  return wrap == Texture::Wrap::mirror ? x - 2 * std::floor(0.5 * x) : x - std::floor(x);
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
  const std::int32_t rgb = texture.texels[std::size_t(y * texture.width + x)];
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
  const double middle = texture.nearest ? 0.0 : 0.5;
  const auto texels = [&](double coordinate, std::int32_t count, Texture::Wrap wrap) {
    return in_first_period(std::clamp(coordinate, -kFarthest, kFarthest), wrap) * count - middle;
  };
  const double s = texels(at.x, texture.width, texture.wrap[0]), t = texels(at.y, texture.height, texture.wrap[1]);
  const double left = std::floor(s), top = std::floor(t);
  const auto x = texel_pair(std::int64_t(left), texture.width, texture.wrap[0]);
  const auto y = texel_pair(std::int64_t(top), texture.height, texture.wrap[1]);
  Vec3f color = encoded(texture, x[0], y[0]);
  if (!texture.nearest) {
    const auto a = float(s - left), b = float(t - top);
    color = (color * (1 - a) + encoded(texture, x[1], y[0]) * a) * (1 - b) +
            (encoded(texture, x[0], y[1]) * (1 - a) + encoded(texture, x[1], y[1]) * a) * b;
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

#include "importers/gltf/read/specular_glossiness.h"

#include <algorithm>
#include <cmath>

#include "importers/gltf/check/specular_glossiness_check.h"

namespace patchlight {
namespace {

constexpr double kDielectric = 0.04;     // specular reflectance of the dielectric part of a metallic-roughness material
constexpr double kMaxDielectric = 0.08;  // an ior of 1.79; a larger one is mostly that of a metal
constexpr double kLeastFraction = 1e-6;

double largest(const Vec3d& color) {
  return std::max({color.x, color.y, color.z});
}

double brightness(const Vec3d& color) {
  return std::sqrt(0.299 * color.x * color.x + 0.587 * color.y * color.y + 0.114 * color.z * color.z);
}

/// The metallic fraction m of a material that has this diffuse and specular brightness, from
/// specular = 0.04 (1 - m) + base m and diffuse (1 - strength) = base (1 - 0.04) (1 - m), solved for m.
double metallic_fraction(double diffuse, double specular, double strength) {
  if (specular < kDielectric) return 0.0;
  const double a = kDielectric;
  const double b = diffuse * (1.0 - strength) / (1.0 - kDielectric) + specular - 2.0 * kDielectric;
  const double c = kDielectric - specular;
  return std::clamp((-b + std::sqrt(std::max(b * b - 4.0 * a * c, 0.0))) / (2.0 * a), 0.0, 1.0);
}

/// The base colour for a metallic fraction: from the diffuse part where it is small, from the specular one where it is
/// large.
Vec3d base_color(const Vec3d& diffuse, const Vec3d& specular, double metallic) {
  const double from_diffuse =
      (1.0 - largest(specular)) / (1.0 - kDielectric) / std::max(1.0 - metallic, kLeastFraction);
  const double weight = metallic * metallic;
  Vec3d base;
  for (int i = 0; i < 3; ++i) {
    const double from_specular = (specular[i] - kDielectric * (1.0 - metallic)) / std::max(metallic, kLeastFraction);
    base[i] = std::clamp((1.0 - weight) * diffuse[i] * from_diffuse + weight * from_specular, 0.0, 1.0);
  }
  return base;
}

/// Scales the base colour texture to a mean of `base`, as far as factors up to 1 can. That of a metal, mostly black, is
/// left out unless its alpha is needed.
void set_base_color(const Vec3d& base, const Vec3d& texture_mean, bool needs_alpha,
                    tinygltf::PbrMetallicRoughness& pbr) {
  if (pbr.metallicFactor > 0.5 && !needs_alpha) pbr.baseColorTexture.index = -1;
  const bool textured = pbr.baseColorTexture.index >= 0;
  for (int i = 0; i < 3; ++i)
    pbr.baseColorFactor[static_cast<std::size_t>(i)] =
        textured ? std::min(base[i] / std::max(texture_mean[i], kLeastFraction), 1.0) : base[i];
}

void convert(const tinygltf::Value& extension, SceneTextures& textures, tinygltf::Material& material) {
  Vec3d specular(1.0);
  double glossiness = 1.0;
  if (extension.Has("specularFactor"))
    for (int i = 0; i < 3; ++i) specular[i] = extension.Get("specularFactor").Get(i).GetNumberAsDouble();
  if (extension.Has("glossinessFactor")) glossiness = extension.Get("glossinessFactor").GetNumberAsDouble();
  if (extension.Has("specularGlossinessTexture")) {
    tinygltf::TextureInfo info;
    info.index = extension.Get("specularGlossinessTexture").Get("index").GetNumberAsInt();
    specular *= textures.mean(info, TextureEncoding::srgb);
    glossiness *= textures.mean(info, TextureEncoding::alpha).x;
  }
  tinygltf::PbrMetallicRoughness& pbr = material.pbrMetallicRoughness;
  pbr.roughnessFactor = 1.0 - glossiness;
  if (largest(specular) <= kMaxDielectric) return;

  const Vec3d mean = textures.mean(pbr.baseColorTexture, TextureEncoding::srgb);
  Vec3d diffuse = mean;
  for (int i = 0; i < 3; ++i) diffuse[i] *= pbr.baseColorFactor.at(static_cast<std::size_t>(i));
  pbr.metallicFactor = metallic_fraction(brightness(diffuse), brightness(specular), largest(specular));
  set_base_color(base_color(diffuse, specular, pbr.metallicFactor), mean, material.alphaMode != "OPAQUE", pbr);
}

}  // namespace

void convert_specular_glossiness(GltfModel& model, const std::vector<char>& used, SceneTextures& textures) {
  for (std::size_t i = 0; i < model.gltf.materials.size(); ++i) {
    tinygltf::Material& material = model.gltf.materials[i];
    const auto extension = material.extensions.find(kSpecularGlossiness);
    if (used[i] && extension != material.extensions.end()) convert(extension->second, textures, material);
  }
}

}  // namespace patchlight

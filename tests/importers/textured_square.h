#pragma once
#include "tests/images.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {

/// A PNG of one row of RGBA texels.
inline void write_row(const std::filesystem::path& file, const std::vector<std::array<unsigned char, 4>>& texels) {
  Pixels row{int(texels.size()), 1, 4};
  for (const auto& texel : texels)
    for (const unsigned char value : texel) row.values.push_back(float(value) / 255);
  write_image(file, row, PixelType::byte);
}

/// A unit square with texture coordinates equal to x and y. Texture i uses images[i], without filtering.
inline GltfBuilder textured_square(const Json& material, const std::vector<std::string>& images) {
  GltfBuilder gltf = single_mesh(grid(1), material);
  gltf.primitive(0)["attributes"]["TEXCOORD_0"] =
      gltf.accessor(std::vector<Vec2f>{{0, 0}, {1, 0}, {0, 1}, {1, 1}}, 5126, "VEC2");
  gltf.json["samplers"] = {{{"magFilter", 9728}}};  // nearest
  for (std::size_t i = 0; i < images.size(); ++i) {
    gltf.json["textures"].push_back({{"source", i}, {"sampler", 0}});
    gltf.json["images"].push_back({{"uri", images[i]}});
  }
  return gltf;
}

/// (u,v) of a primitive of textured_square at (x, y).
inline Imath::V2d uv_of(const PatchSet& scene, std::int32_t i, double x, double y) {
  const auto& c = scene.primitives[std::size_t(i)].corners;
  const Vec3d at = Vec3d(x, y, c[0].z) - c[0];
  return {at ^ (c[1] - c[0]), at ^ (c[3] - c[0])};
}

/// The patch of a primitive whose centre is at x. Throws: std::runtime_error without one.
inline const Patch& patch_at(const PatchSet& scene, double x, std::int32_t primitive = 0) {
  for (const Patch& patch : scene.patches)
    if (patch.primitive == primitive && std::abs(patch.center.x - x) < 1e-3) return patch;
  throw std::runtime_error("no patch at this x");
}

}  // namespace patchlight::test

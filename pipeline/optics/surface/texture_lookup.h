#pragma once
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Texture coordinates of base colour at (u,v) of primitive `i`; (u,v) if the scene has none.
Imath::V2d texcoord_at(const PatchSet& scene, std::int32_t i, double u, double v);

/// Linear colour of a texture. Texels are interpolated in their sRGB encoding, like 8-bit images in path tracers and on
/// GPUs without sRGB formats.
Color texture_color(const Texture& texture, const Imath::V2d& at);

/// Diffuse reflectance at (u,v) of primitive `i`, for which is_colored() holds: the material's tint and the
/// non-metallic part of its metal, times base colour; limited by max_diffuse_reflectance().
Color colored_reflectance(const PatchSet& scene, std::int32_t i, double u, double v);

/// Specular reflection of a metal at a surface point.
struct MetalProperties {
  Color specular{0.0f};  ///< Reflectance, each in [0,1].
  float roughness = 1.0f;
};

/// Specular reflection at (u,v) of primitive `i`: the material's, varied by textures and vertex colours.
MetalProperties metal_properties_at(const PatchSet& scene, std::int32_t i, double u, double v);

/// Radiant exitance at (u,v) of primitive `i`, which has an emission texture, W/m2.
Color textured_emission(const PatchSet& scene, std::int32_t i, double u, double v);

/// Alpha of a mask, in [0,1], by the mask's filter.
float mask_value(const Texture& mask, const Imath::V2d& at);

/// Vertex colour and alpha at (u,v) of primitive `i`; 1 without vertex colours.
Vec4f vertex_color(const PatchSet& scene, std::int32_t i, double u, double v);

}  // namespace patchlight

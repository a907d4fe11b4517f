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

/// Base colour at (u,v) of primitive `i`: texture times vertex colours.
Color base_color(const PatchSet& scene, std::int32_t i, double u, double v);

/// Roughness and metalness, both in [0,1], by the texture that primitive `i` has for them.
Vec2f roughness_metalness(const PatchSet& scene, std::int32_t i, double u, double v);

/// A vector of the normal texture of primitive `i`, each component in [-1,1]: x along growing s, y against growing t, z
/// out of the surface.
Vec3f tangent_space_normal(const PatchSet& scene, std::int32_t i, double u, double v);

/// Texture coordinates of normal textures at the corners of primitive `i`, which has one.
const Texcoords& normal_texcoords(const PatchSet& scene, std::int32_t i);

/// Radiant exitance at (u,v) of primitive `i`, which has an emission texture, W/m2.
Color textured_emission(const PatchSet& scene, std::int32_t i, double u, double v);

/// Alpha of a mask, in [0,1], by the mask's filter.
float mask_value(const Texture& mask, const Imath::V2d& at);

/// Vertex colour and alpha at (u,v) of primitive `i`; 1 without vertex colours.
Vec4f vertex_color(const PatchSet& scene, std::int32_t i, double u, double v);

}  // namespace patchlight

#pragma once
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Texture coordinates of base colour at (u,v) of primitive `i`; (u,v) itself for a scene without any.
Imath::V2d texcoord_at(const PatchSet& scene, std::int32_t i, double u, double v);

/// The linear colour of a texture, bilinear between texels in their sRGB encoding, as path tracers and GPUs of plain
/// 8-bit images filter.
Color texture_color(const Texture& texture, const Imath::V2d& at);

/// Diffuse reflectance at (u,v) of primitive `i`, which is colored: its material's tint, and what its finish leaves of
/// its metal, times texture and colours; in range beside its metallic part.
Color colored_reflectance(const PatchSet& scene, std::int32_t i, double u, double v);

/// What a surface reflects as a metal.
struct MetallicRoughness {
  Color specular{0.0f};  ///< Each in [0,1].
  float roughness = 1.0f;
};

/// At (u,v) of primitive `i`: its material's, or where textures or colours vary that, as they say there.
MetallicRoughness metallic_roughness_at(const PatchSet& scene, std::int32_t i, double u, double v);

/// Radiant exitance at (u,v) of primitive `i`, which has an emission texture, W/m2.
Color textured_emission(const PatchSet& scene, std::int32_t i, double u, double v);

/// Alpha of a mask in [0,1], bilinear between texels.
float mask_value(const Texture& mask, const Imath::V2d& at);

/// What the vertices of primitive `i` say at (u,v); ones where they have no colours.
Vec4f vertex_color(const PatchSet& scene, std::int32_t i, double u, double v);

}  // namespace patchlight

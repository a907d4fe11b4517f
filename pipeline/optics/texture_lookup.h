#pragma once
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Texture coordinates at (u,v) of primitive `i`; (u,v) itself for a scene without any.
Imath::V2d texcoord_at(const PatchSet& scene, std::int32_t i, double u, double v);

/// The linear colour of a texture, bilinear between texels in their sRGB encoding, as path tracers and GPUs of plain
/// 8-bit images filter.
Color texture_color(const Texture& texture, const Imath::V2d& at);

/// Diffuse reflectance at (u,v) of primitive `i`, which has a texture: in range beside its metallic part.
Color textured_reflectance(const PatchSet& scene, std::int32_t i, double u, double v);

}  // namespace patchlight

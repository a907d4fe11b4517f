#pragma once
#include "pipeline/model/environment.h"

namespace patchlight {

// Directions are in world space, away from the viewer, of any length.

/// Image coordinates of a direction, in texels; centres of texels are at half-integers. Without rotation, the image's
/// centre is along +X, as in Blender.
Vec2f texel_at(const Environment& sky, const Vec3f& direction);

/// The direction of image coordinates; inverse of texel_at().
Vec3d direction_at(const Environment& sky, double x, double y);

/// Radiance with suns, as cameras and mirrors see it, bilinear between texels, W/m2/sr.
Color sky_radiance(const Environment& sky, const Vec3f& direction);

/// Radiance without suns: the largest channel is limited to Environment::clip.
Color clipped_radiance(const Environment& sky, const Vec3f& direction);
Color clipped(const Environment& sky, const Color& radiance);

/// The environment cell of a direction.
std::int32_t sky_cell(const Environment& sky, const Vec3f& direction);

}  // namespace patchlight

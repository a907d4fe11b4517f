#pragma once
#include "pipeline/model/environment.h"

namespace patchlight {

// Directions are of any length, in the world, away from what sees them.

/// Which texel shows what lies in a direction: columns and rows, not rounded, of which a texel's own middle has halves.
/// The middle of the image lies along +X, as Blender has it, but for the turn.
Vec2f texel_at(const Environment& sky, const Vec3f& direction);

/// The direction of such a place.
Vec3d direction_at(const Environment& sky, double x, double y);

/// Radiance as cameras and mirrors see it, bilinear between texels, W/m2/sr.
Color sky_radiance(const Environment& sky, const Vec3f& direction);

/// The same without suns.
Color clipped_radiance(const Environment& sky, const Vec3f& direction);
Color clipped(const Environment& sky, const Color& radiance);

/// The cell that a direction lies in.
std::int32_t sky_cell(const Environment& sky, const Vec3f& direction);

}  // namespace patchlight

#pragma once
#include "pipeline/model/light.h"

namespace patchlight {

/// Relative intensity in a direction of unit length, bilinear in the vertical and the horizontal angle. Axes of the
/// direction: x in half-plane C0, y in C90, z opposite to the nadir.
///
/// Type C: the vertical angle is that to the nadir, the horizontal one turns from x towards y. Type B: from the nadir,
/// the vertical angle turns towards x, the horizontal one leans towards -y. Type A: the horizontal angle turns towards
/// x, the vertical one leans towards y. (LM-63: horizontal angles are counter-clockwise for type C, else clockwise.)
double relative_intensity(const LightDistribution& distribution, const Vec3d& direction);

}  // namespace patchlight

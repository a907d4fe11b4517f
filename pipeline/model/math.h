#pragma once
#include <ImathColor.h>
#include <ImathMatrix.h>
#include <ImathVec.h>

namespace patchlight {

// Default-constructed Imath vectors are uninitialised: write Vec3d(0.0), also in resize().
using Vec2f = Imath::V2f;
using Vec2d = Imath::V2d;
using Vec3f = Imath::V3f;
using Vec3d = Imath::V3d;
using Vec4f = Imath::V4f;
using Matrix4 = Imath::M44d;  ///< Row vectors: p' = p * M.
using Color = Imath::C3f;     ///< Scene-linear Rec.709.

constexpr double kPi = 3.14159265358979323846;

}  // namespace patchlight

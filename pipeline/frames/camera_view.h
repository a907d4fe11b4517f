#pragma once
#include <ImathBox.h>

#include "pipeline/model/camera.h"

namespace patchlight {

/// Whether a camera stands outside a box and its view, a pyramid or in parallel projection a prism, between its clip
/// planes, does not touch the box. `aspect`: width over height of the image. May be false near the box's edges for a
/// view that passes by.
bool misses(const Camera& camera, double aspect, const Imath::Box3d& box);

}  // namespace patchlight

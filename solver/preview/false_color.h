#pragma once
#include <span>
#include <string>

#include "pipeline/image/image_file.h"

namespace patchlight {

/// A colour of the viridis map for x in [0,1], display-ready.
Color false_color(float x);

/// Draws a vertical scale of false_color from 0 to `largest`, with numbers at its ends and middle and `unit` above,
/// into the right edge of an image.
void draw_scale(Image& image, float largest, const std::string& unit);

}  // namespace patchlight

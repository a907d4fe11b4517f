#pragma once
#include <span>
#include <string>

#include "pipeline/image/image_file.h"

namespace patchlight {

/// Colour of the viridis map, display-ready; x is clamped to [0,1].
Color false_color(float x);

/// Draws a vertical scale of false_color from 0 to `largest` at the right edge of an image, with numbers at its ends
/// and middle and `unit` above.
void draw_scale(Image& image, float largest, const std::string& unit);

}  // namespace patchlight

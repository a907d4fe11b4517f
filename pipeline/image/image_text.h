#pragma once
#include <string>

#include "pipeline/image/image_file.h"

namespace patchlight {

/// Draws one line of text into display-ready pixels: its left end and baseline at (x, y), `size` pixels high, cut off
/// at the image's edges. Returns false, and draws nothing, if no font is installed that OpenImageIO can use.
bool draw_text(Image& image, int x, int y, const std::string& text, int size, const Color& color);

/// The width in pixels that draw_text would take; 0 without a font.
int text_width(const std::string& text, int size);

/// What these two load when they are first called.
extern "C" bool render_text(Image& image, int x, int y, const std::string& text, int size, const Color& color);
extern "C" int measure_text(const std::string& text, int size);

}  // namespace patchlight

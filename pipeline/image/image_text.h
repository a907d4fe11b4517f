#pragma once
#include <string>

#include "pipeline/image/image_file.h"

namespace patchlight {

/// Draws one line of text into display-encoded pixels, `size` pixels high, with its left end and baseline at (x, y),
/// clipped at the image's edges. Returns false and draws nothing if OpenImageIO finds no font.
bool draw_text(Image& image, int x, int y, const std::string& text, int size, const Color& color);

/// Width of a text of draw_text(), in pixels; 0 without a font.
int text_width(const std::string& text, int size);

/// Functions of the module patchlight-text, which the first call of the two above loads.
extern "C" bool render_text(Image& image, int x, int y, const std::string& text, int size, const Color& color);
extern "C" int measure_text(const std::string& text, int size);

}  // namespace patchlight

#include "solver/preview/false_color.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace patchlight {

namespace {

// Glyphs of 3 x 5 pixels; rows from the top, leftmost pixel in the highest bit.
struct Glyph {
  char letter;
  std::array<std::uint8_t, 5> rows;
};
constexpr std::array<Glyph, 18> kGlyphs{{{'0', {7, 5, 5, 5, 7}},
                                         {'1', {2, 6, 2, 2, 7}},
                                         {'2', {7, 1, 7, 4, 7}},
                                         {'3', {7, 1, 7, 1, 7}},
                                         {'4', {5, 5, 7, 1, 1}},
                                         {'5', {7, 4, 7, 1, 7}},
                                         {'6', {7, 4, 7, 5, 7}},
                                         {'7', {7, 1, 2, 2, 2}},
                                         {'8', {7, 5, 7, 5, 7}},
                                         {'9', {7, 5, 7, 1, 7}},
                                         {'.', {0, 0, 0, 0, 2}},
                                         {'-', {0, 0, 7, 0, 0}},
                                         {'+', {0, 2, 7, 2, 0}},
                                         {'e', {0, 7, 7, 4, 7}},
                                         {'W', {5, 5, 5, 7, 5}},
                                         {'/', {1, 1, 2, 4, 4}},
                                         {'m', {0, 5, 7, 5, 5}},
                                         {'\'', {6, 2, 4, 6, 0}}}};

void fill(Image& image, int x0, int y0, int x1, int y1, const Color& color) {
  for (int y = std::max(y0, 0); y < std::min(y1, image.height); ++y)
    for (int x = std::max(x0, 0); x < std::min(x1, image.width); ++x)
      image.pixels[std::size_t(y) * image.width + x] = color;
}

/// Text that ends at column `right`.
void draw_text(Image& image, const std::string& text, int right, int top, int size) {
  int x = right - 4 * size * int(text.size());
  fill(image, x - size, top - size, right, top + 6 * size, Color(0.0f));
  for (const char c : text) {
    const auto glyph = std::find_if(kGlyphs.begin(), kGlyphs.end(), [c](const Glyph& g) { return g.letter == c; });
    for (int row = 0; glyph != kGlyphs.end() && row < 5; ++row)
      for (int column = 0; column < 3; ++column)
        if (glyph->rows[row] & (4 >> column))
          fill(image, x + column * size, top + row * size, x + (column + 1) * size, top + (row + 1) * size,
               Color(1.0f));
    x += 4 * size;
  }
}

}  // namespace

Color false_color(float x) {
  static const std::array<Color, 9> stops{
      Color(0.267f, 0.005f, 0.329f), Color(0.279f, 0.175f, 0.483f), Color(0.230f, 0.322f, 0.546f),
      Color(0.173f, 0.449f, 0.558f), Color(0.128f, 0.567f, 0.551f), Color(0.158f, 0.684f, 0.502f),
      Color(0.369f, 0.789f, 0.383f), Color(0.678f, 0.864f, 0.190f), Color(0.993f, 0.906f, 0.144f)};
  const float at = std::clamp(x, 0.0f, 1.0f) * float(stops.size() - 1);
  const std::size_t low = std::min(std::size_t(at), stops.size() - 2);
  return stops[low] + (stops[low + 1] - stops[low]) * (at - float(low));
}

void draw_scale(Image& image, float largest, const std::string& unit) {
  const int size = std::max(1, image.height / 180);
  const int right = image.width - 4 * size, left = right - 8 * size;
  const int top = 16 * size, bottom = image.height - 8 * size;
  if (left < 0 || bottom <= top) return;
  fill(image, left - size, top - size, right + size, bottom + size, Color(0.0f));
  for (int y = top; y < bottom; ++y)
    fill(image, left, y, right, y + 1, false_color(1.0f - float(y - top) / float(bottom - top)));
  for (const float fraction : {0.0f, 0.5f, 1.0f})
    draw_text(image, fmt::format("{:.3g}", fraction * largest), left - 2 * size,
              bottom - int(fraction * float(bottom - top)) - 3 * size, size);
  draw_text(image, unit, right + size, 4 * size, size);
}

}  // namespace patchlight

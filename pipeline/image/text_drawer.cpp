#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include "pipeline/image/image_text.h"

namespace patchlight {

namespace {

/// The first installed font of a list of common ones; empty if none is installed.
const std::string& font() {
  static const std::string found = [] {
    for (const char* name : {"DejaVuSans", "LiberationSans-Regular", "NotoSans-Regular", "FreeSans", "DroidSans"})
      if (OIIO::ImageBufAlgo::text_size("x", 16, name).defined()) return std::string(name);
    return std::string();
  }();
  return found;
}

}  // namespace

bool render_text(Image& image, int x, int y, const std::string& text, int size, const Color& color) {
  if (font().empty()) return false;
  OIIO::ImageBuf pixels(OIIO::ImageSpec(image.width, image.height, 3, OIIO::TypeDesc::FLOAT), image.pixels.data());
  return OIIO::ImageBufAlgo::render_text(pixels, x, y, text, size, font(), {color.x, color.y, color.z});
}

int measure_text(const std::string& text, int size) {
  if (font().empty()) return 0;
  return OIIO::ImageBufAlgo::text_size(text, size, font()).width();
}

}  // namespace patchlight

#include "pipeline/image/image_text.h"

#include "pipeline/system/on_demand.h"

namespace patchlight {

bool draw_text(Image& image, int x, int y, const std::string& text, int size, const Color& color) {
  static auto* const draw = on_demand<decltype(render_text)>("patchlight-text", "render_text");
  return draw(image, x, y, text, size, color);
}

int text_width(const std::string& text, int size) {
  static auto* const width = on_demand<decltype(measure_text)>("patchlight-text", "measure_text");
  return width(text, size);
}

}  // namespace patchlight

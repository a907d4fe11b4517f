#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace patchlight {

/// An image that is mapped onto surfaces.
struct Texture {
  enum class Wrap : std::int32_t { repeat = 0, clamp = 1, mirror = 2 };

  std::int32_t width = 0, height = 0;
  std::array<Wrap, 2> wrap{Wrap::repeat, Wrap::repeat};  ///< Wrap modes along s and t.
  bool nearest = false;                                  ///< Nearest-neighbour filter; otherwise bilinear.
  std::vector<std::int32_t> texels;  ///< 0xRRGGBB, sRGB-encoded, rows from the top (t = 0). Shape: [height * width].
};

}  // namespace patchlight

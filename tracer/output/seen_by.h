#pragma once
#include <cstdint>

namespace patchlight {

/// How the camera sees what gives light to a pixel: itself, also behind what lets light pass straight, or by the first
/// surface that reflects or turns the path.
enum class SeenBy : std::uint8_t { itself, metal, coat, glass };

}  // namespace patchlight

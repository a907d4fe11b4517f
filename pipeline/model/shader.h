#pragma once
#include <array>
#include <string>

namespace patchlight {

/// Expressions for red, green and blue at a surface point. Either all three are set, or none.
using ColorExpressions = std::array<std::string, 3>;

inline bool is_set(const ColorExpressions& color) {
  return !color[0].empty();
}

/// Replaces a material's reflectance or emission by expressions of the surface point.
struct Shader {
  std::string name;              ///< Glob pattern (fnmatch) for material or node names.
  ColorExpressions reflectance;  ///< Diffuse.
  ColorExpressions emission;     ///< Radiant exitance, W/m2.
};

}  // namespace patchlight

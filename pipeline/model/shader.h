#pragma once
#include <array>
#include <string>

namespace patchlight {

/// Red, green and blue as expressions of a surface point; all three are set, or none.
using ColorExpressions = std::array<std::string, 3>;

inline bool is_set(const ColorExpressions& color) {
  return !color[0].empty();
}

/// Replaces what a material says, point by point.
struct Shader {
  std::string name;              ///< Glob (fnmatch) of the materials or nodes that it is for.
  ColorExpressions reflectance;  ///< Diffuse.
  ColorExpressions emission;     ///< Radiant exitance, W/m2.
};

}  // namespace patchlight

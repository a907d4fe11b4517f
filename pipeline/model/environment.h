#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// Light from infinitely far away in all directions: an environment map.
///
/// The solver uses cells of equal solid angle: rows of equal height in y from +Y down, and twice as many columns in
/// azimuth. Sources that are too bright and small for the cells are suns in PatchSet::lights instead.
struct Environment {
  std::int32_t light_group = 0;
  int width = 1, height = 1;  ///< Size of `texels`.
  std::vector<Color> texels;  ///< [height * width] Radiance with suns, W/m2/sr, equirectangular; rows from +Y down.
  double turn = 0.0;          ///< Rotation of the texels, in full turns, counter-clockwise seen from above.
  float clip = 0.0f;          ///< Largest channel above which a texel belongs to a sun, W/m2/sr; 0: no suns.
  int rows = 1;               ///< Rows of cells; a single row is a single cell.
  std::vector<Color> cells;   ///< Mean radiance of each cell without suns, W/m2/sr.
};

}  // namespace patchlight

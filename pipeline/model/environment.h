#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// Light that comes from all around, from infinitely far away.
///
/// Solving knows it by cells of equal solid angle: rows of equal height in y from +Y down, twice as many columns in
/// azimuth. What is too bright and small for them is apart from it, as suns among PatchSet::lights.
struct Environment {
  std::int32_t light_group = 0;
  int width = 1, height = 1;  ///< Of `texels`.
  std::vector<Color> texels;  ///< [height * width] Radiance, W/m2/sr, equirectangular, all there is; rows from +Y down.
  double turn = 0.0;          ///< Part of a full turn by which they are turned, counter-clockwise from above.
  float clip = 0.0f;          ///< Radiance above which texels are suns, W/m2/sr, of the largest channel; 0: none are.
  int rows = 1;               ///< Of cells; 1 row has 1 column.
  std::vector<Color> cells;   ///< Mean radiance, W/m2/sr, without suns.
};

}  // namespace patchlight

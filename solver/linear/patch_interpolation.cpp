#include "solver/linear/patch_interpolation.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

Spectrum interpolate(const PatchSet& scene, const PatchLookup& lookup, std::int32_t patch, float u, float v,
                     const std::vector<Color>& field) {
  const std::int32_t primitive = scene.patches[patch].primitive;
  const bool periodic = scene.primitives[primitive].shape == Primitive::Shape::sphere;
  const auto along_row = [&](int row) {
    const PatchLookup::Row& cells = lookup.row(primitive, row);
    const float x = u * float(cells.cells) - 0.5f;
    const int k = int(std::floor(x));
    const auto at = [&](int cell) {
      const int index = periodic ? (cell + cells.cells) % cells.cells : std::clamp(cell, 0, cells.cells - 1);
      return Spectrum(field[lookup.nearest(cells, index)]);
    };
    const double fraction = double(x) - k;
    return at(k) * Spectrum(1 - fraction) + at(k + 1) * Spectrum(fraction);
  };
  const int rows = lookup.rows(primitive);
  const auto lower = [](float x, int cells) { return int(std::floor(x * float(cells) - 0.5f)); };
  if (!periodic && !lookup.is_open(primitive, lower(u, lookup.row(primitive, 0).cells), lower(v, rows)))
    return Spectrum(field[patch]);
  const float y = std::clamp(v * float(rows) - 0.5f, 0.0f, float(rows - 1));
  const int k = std::min(int(y), std::max(rows - 2, 0));
  const double fraction = double(y) - k;
  return along_row(k) * Spectrum(1 - fraction) + along_row(std::min(k + 1, rows - 1)) * Spectrum(fraction);
}

}  // namespace patchlight

#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Finds the patch at (u,v) of a primitive, by its rows of cells.
///
/// Rows of a quad have the same number of cells of equal size. Rows of a sphere are rings of equal polar angle; their
/// numbers of cells differ.
class PatchLookup {
 public:
  struct Row {
    std::int32_t first;  ///< Patch at u = 0.
    std::int32_t cells;  ///< Number of patches.
  };

  explicit PatchLookup(const PatchSet& scene);

  /// Number of rows of primitive `i`; rows have growing v.
  int rows(std::int32_t i) const { return int(starts_[i + 1] - starts_[i]); }
  const Row& row(std::int32_t i, int k) const { return rows_[starts_[i] + k]; }

  /// The patch at (u,v) of primitive `i`; u and v in [0,1].
  std::int32_t patch(std::int32_t i, float u, float v) const {
    const Row& at = row(i, cell(v, rows(i)));
    return at.first + cell(u, at.cells);
  }

  /// The cell of x in [0,1], among `count` equal cells.
  static int cell(float x, int count) {
    const int k = int(x * float(count));
    return k < 0 ? 0 : (k >= count ? count - 1 : k);
  }

 private:
  std::vector<std::uint32_t> starts_;
  std::vector<Row> rows_;
};

}  // namespace patchlight

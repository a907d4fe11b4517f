#pragma once
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/cuts/crossings.h"

namespace patchlight {

/// Tells which cells are too large for the light around what stands on them, however large their patches are: beside a
/// crossing they may be half as large as the other surface is high, within 1/64 and 1/12 of the crossing's extent, and
/// half of their distance from it farther off. Where so many things stand that this would take many cells, none are
/// smaller than a size by which it does not.
class FineDetail {
 public:
  /// `crossings`, `at_edges`: of the primitives, and along their edges. Shape: [primitives].
  FineDetail(const PatchSet& scene, std::vector<std::vector<Crossing>> crossings,
             const std::vector<std::vector<Crossing>>& at_edges);

  bool is_too_large(const Patch& cell) const;

 private:
  const PatchSet& scene_;
  std::vector<std::vector<Crossing>> crossings_;  ///< [primitives].
  double smallest_ = 0;                           ///< Size of cells, m.
};

}  // namespace patchlight

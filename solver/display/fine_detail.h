#pragma once
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/cuts/crossings.h"

namespace patchlight {

/// Tells which cells are too large for the light around what stands on them, however large their patches are: beside a
/// crossing they may be 1/24 of its extent, and half of their distance from it farther off. Where so many things stand
/// that this would take many cells, none are smaller than a size by which it does not.
class FineDetail {
 public:
  FineDetail(const PatchSet& scene, const std::vector<std::vector<Crossing>>& crossings);

  bool is_too_large(const Patch& cell) const;

 private:
  const PatchSet& scene_;
  const std::vector<std::vector<Crossing>>& crossings_;
  double smallest_ = 0;  ///< Size of cells, m.
};

}  // namespace patchlight

#pragma once
#include <string>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// The first thing that breaks PatchSet's promises, and the dataset it is in; empty if all hold.
struct PatchFault {
  std::string what;
  std::string where;
  explicit operator bool() const { return !what.empty(); }
};

PatchFault find_fault(const PatchSet& scene);

}  // namespace patchlight

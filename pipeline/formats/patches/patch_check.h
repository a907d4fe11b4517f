#pragma once
#include <string>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// The first violation of PatchSet's invariants, and its dataset; empty if all hold.
struct PatchFault {
  std::string what;
  std::string where;
  explicit operator bool() const { return !what.empty(); }
};

PatchFault find_fault(const PatchSet& scene);

}  // namespace patchlight

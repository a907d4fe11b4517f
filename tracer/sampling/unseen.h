#pragma once
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Whether cameras do not see a primitive.
inline bool is_unseen(const PatchSet& scene, std::int32_t primitive) {
  return !scene.unseen.empty() && scene.unseen[scene.primitives[primitive].node] != 0;
}

}  // namespace patchlight

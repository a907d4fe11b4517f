#include "pipeline/optics/sampling/patch_lookup.h"

namespace patchlight {

PatchLookup::PatchLookup(const PatchSet& scene) {
  starts_.reserve(scene.primitives.size() + 1);
  std::int32_t patch = 0;
  const auto count = std::int32_t(scene.patches.size());
  for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) {
    starts_.push_back(std::uint32_t(rows_.size()));
    while (patch < count && scene.patches[patch].primitive == i) {
      const std::int32_t first = patch;
      const float v0 = scene.patches[first].v0;
      while (patch < count && scene.patches[patch].primitive == i && scene.patches[patch].v0 == v0) ++patch;
      rows_.push_back({first, patch - first});
    }
  }
  starts_.push_back(std::uint32_t(rows_.size()));
}

}  // namespace patchlight

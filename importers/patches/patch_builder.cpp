#include "importers/patches/patch_builder.h"

namespace patchlight {

std::vector<Patch> build_patches(const std::vector<Primitive>& primitives,
                                 const std::vector<SurfaceMaterial>& materials,
                                 const std::vector<PatchTarget>& targets) {
  std::vector<Patch> patches;
  for (std::size_t i = 0; i < primitives.size(); ++i)
    append_patches(primitives[i], static_cast<std::int32_t>(i), materials[primitives[i].material], targets[i], patches);
  return patches;
}

}  // namespace patchlight

#include "solver/form_factors/coated_rows.h"

#include <algorithm>

namespace patchlight {

SpectrumField row_reflectance(const PatchSet& scene, bool coats) {
  SpectrumField reflectance;
  reflectance.reserve(scene.patches.size());
  for (const Patch& patch : scene.patches) {
    const Primitive& primitive = scene.primitives[patch.primitive];
    if (!coats || !passes_by_chance(scene, primitive)) {
      reflectance.emplace_back(patch.total_reflectance());
      continue;
    }
    const float part = untransmitted_part(scene, primitive);
    reflectance.emplace_back(part > 0 ? patch.reflectance / part : Color(0.0f));
  }
  return reflectance;
}

bool has_metals(const PatchSet& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& material) { return material.specular != Color(0.0f); });
}

}  // namespace patchlight

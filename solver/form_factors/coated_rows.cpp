#include "solver/form_factors/coated_rows.h"

#include <algorithm>

namespace patchlight {

SpectrumField row_reflectance(const PatchSet& scene, bool coats) {
  SpectrumField reflectance;
  reflectance.reserve(scene.patches.size());
  for (const Patch& patch : scene.patches) {
    const bool by_chance = coats && passes_by_chance(scene, scene.primitives[patch.primitive]);
    reflectance.emplace_back(by_chance ? patch.reflectance : patch.total_reflectance());
  }
  return reflectance;
}

bool has_metals(const PatchSet& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& material) { return material.specular != Color(0.0f); });
}

}  // namespace patchlight

#include "solver/form_factors/coated_rows.h"

#include <algorithm>

namespace patchlight {

bool has_metals(const PatchSet& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& material) { return material.specular != Color(0.0f); });
}

}  // namespace patchlight

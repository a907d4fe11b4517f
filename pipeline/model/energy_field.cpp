#include "pipeline/model/energy_field.h"

namespace patchlight {

std::vector<Color> radiosity(const PatchSet& scene, const EnergyField& energy) {
  std::vector<Color> result(scene.patches.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    Color irradiance(0.0f);
    for (const auto& group : energy.groups) irradiance += group.direct[i] + group.indirect[i];
    result[i] = scene.patches[i].emission + scene.patches[i].reflectance * irradiance;
  }
  return result;
}

}  // namespace patchlight

#pragma once
#include <string>

#include "pipeline/model/energy_field.h"

namespace patchlight {

/// What is in a scene, for people: counts, areas, materials, light groups, cameras.
std::string describe(const PatchSet& scene);

/// What is in a solution.
std::string describe(const EnergyField& energy);

}  // namespace patchlight

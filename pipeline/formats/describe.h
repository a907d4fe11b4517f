#pragma once
#include <string>

#include "pipeline/model/energy_field.h"
#include "pipeline/model/transport.h"

namespace patchlight {

/// What is in a scene, for people: counts, areas, materials, light groups, cameras.
std::string describe(const PatchSet& scene);

/// Who sees whom, in numbers.
std::string describe(const Transport& transport);

/// What is in a solution.
std::string describe(const EnergyField& energy);

}  // namespace patchlight

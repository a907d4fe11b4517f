#pragma once
#include <string>

#include "pipeline/model/energy_field.h"
#include "pipeline/model/transport.h"

namespace patchlight {

/// Human-readable summary of a scene: counts, areas, materials, light groups, cameras.
std::string describe(const PatchSet& scene);

/// Human-readable summary of a transport.
std::string describe(const Transport& transport);

/// Human-readable summary of a solution.
std::string describe(const EnergyField& energy);

}  // namespace patchlight

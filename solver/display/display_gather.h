#pragma once
#include <vector>

#include "pipeline/model/energy_field.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/model/transport.h"

namespace patchlight {

/// Sets each group's `display`: the irradiance that the display mesh's vertices gather from a solution, in several
/// passes, each of which uses the irradiance that the previous one found at the leaves.
/// Throws: Error (bad_data) if the irradiance is too large for single precision.
void gather_display(const PatchSet& scene, const Transport& transport, std::vector<EnergyField::Group>& groups);

}  // namespace patchlight

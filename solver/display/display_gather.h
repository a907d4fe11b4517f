#pragma once
#include <vector>

#include "pipeline/model/energy_field.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/model/transport.h"

namespace patchlight {

/// Sets each group's `display`: irradiance that the display mesh's vertices gather of a solution, in passes, each of
/// which sees what the one before it found at the leaves. Throws: Error (bad_data) for irradiance beyond single
/// precision.
void gather_display(const PatchSet& scene, const Transport& transport, std::vector<EnergyField::Group>& groups);

}  // namespace patchlight

#pragma once
#include <vector>

#include "pipeline/model/energy_field.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/model/transport.h"
#include "solver/linear/spectrum.h"

namespace patchlight {

/// The first pass uses means of whole patches; the third serves surfaces that stand on divided patches.
inline constexpr int kDisplayPasses = 3;

/// Sets each group's `display`: the irradiance that the display mesh's vertices gather from a solution, in several
/// passes, each of which uses the irradiance that the previous one found at the leaves. Returns for each patch the mean
/// of that irradiance minus the patch's own, of all groups together, W/m2; 0 for patches that the mesh does not divide.
/// Throws: Error (bad_data) if the irradiance is too large for single precision.
SpectrumField gather_display(const PatchSet& scene, const Transport& transport,
                             std::vector<EnergyField::Group>& groups);

}  // namespace patchlight

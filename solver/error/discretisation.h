#pragma once
#include "pipeline/model/energy_field.h"
#include "pipeline/model/transport.h"
#include "solver/linear/spectrum.h"

namespace patchlight {

/// Adds to a solution's estimate the error of the patches themselves, which are too coarse for its light: all bounds
/// and errors grow by it. `difference`: what gather_display() returns, with light of up to `reflections` reflections; a
/// part of it that the stated standard errors explain is left out.
void add_discretisation_error(const PatchSet& scene, const Transport& transport, const SpectrumField& difference,
                              int reflections, EnergyField& energy);

}  // namespace patchlight

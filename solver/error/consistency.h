#pragma once
#include "solver/linear/linear_system.h"

namespace patchlight {

/// Covered patch areas times their visible area fractions, m2. Shape: [n].
std::vector<double> visible_areas(const PatchSet& scene, const Transport& transport);

/// Violation of reciprocity A_i F_ij = A_j F_ji: for every patch j, the column sum of A_i F_ij over i minus A_j times
/// the sum of row j, as an area-weighted relative L2 norm. 0 for exact form factors.
double reciprocity_error(const Transport& transport, const FormFactorRows& rows, const std::vector<double>& areas);

/// Violation of the energy balance: power that leaves patches and by the row sums reaches patches, minus the power that
/// patches receive, over the emitted power, of the worst channel. 0 for exact form factors; 0 without emission.
/// `external_irradiance`, that of lights and the environment, counts as emitted and is part of `irradiance`.
/// All fields are sums over the light groups, W/m2. Shape: [n].
double balance_error(const FormFactorRows& rows, const std::vector<double>& areas, const SpectrumField& reflectance,
                     const SpectrumField& emission, const SpectrumField& external_irradiance,
                     const SpectrumField& irradiance);

}  // namespace patchlight

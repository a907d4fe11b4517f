#pragma once
#include "solver/linear/linear_system.h"

namespace patchlight {

/// The areas of those parts of patches that light can reach, m2: rows by rays are the shorter for what is hidden.
std::vector<double> visible_areas(const PatchSet& scene, const Transport& transport);

/// Area-weighted relative L2 norm of what breaks A_i F_ij = A_j F_ji, summed over i for every patch j: what all rows
/// together see of j against what j sees of them. 0 for exact form factors.
double reciprocity_error(const Transport& transport, const FormFactorRows& rows, const std::vector<double>& areas);

/// Emitted power that is neither absorbed by patches nor gone to where nothing is, by the rows of what it leaves, over
/// all emitted power; of the worst channel. 0 for exact form factors; 0 without emission. Of light that no patch sends,
/// what arrives counts as emitted.
/// `emission`, `from_outside` and `irradiance`, which holds that too, in W/m2, [n] and of all light groups.
double balance_error(const FormFactorRows& rows, const std::vector<double>& areas, const SpectrumField& reflectance,
                     const SpectrumField& emission, const SpectrumField& from_outside, const SpectrumField& irradiance);

}  // namespace patchlight

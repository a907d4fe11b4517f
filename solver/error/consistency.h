#pragma once
#include "solver/linear/linear_system.h"

namespace patchlight {

/// Covered patch areas times their visible area fractions, m2, and times what their coats let through where rows go on
/// over them by chance. Shape: [n].
std::vector<double> visible_areas(const PatchSet& scene, const Transport& transport);

/// `areas` with zeros for intangible lamps, which no light meets. Shape: [n].
std::vector<double> receiving_areas(const PatchSet& scene, std::vector<double> areas);

/// Violation of reciprocity A_i F_ij = A_j F_ji: for every patch j, the column sum of A_i F_ij over i minus A_j times
/// the sum of row j, as an area-weighted relative L2 norm. 0 for exact form factors. Patches of area 0 do not count.
double reciprocity_error(const Transport& transport, const FormFactorRows& rows, const std::vector<double>& areas);

/// Light of sampled emitters on coats. Shape of the fields: [n]; empty: no coats.
struct CoatExchange {
  SpectrumField reflected;  ///< Exitance of the coats: see CoatLight.
  SpectrumField unmatched;  ///< Irradiance by surfaces, times (1 - tau) / tau: rows do not tell of it.

  void resize(std::size_t patches) {
    reflected.resize(patches);
    unmatched.resize(patches);
  }
};

/// Violation of the energy balance by a solution. All fields are sums over the light groups, W/m2. Shape: [n].
class EnergyBalance {
 public:
  /// `external_irradiance`, that of lights and the environment, counts as emitted and is part of `irradiance`.
  EnergyBalance(const PatchSet& scene, const FormFactorRows& rows, const std::vector<double>& areas,
                const Scattering& scattering, SpectrumField external_irradiance, const SpectrumField& irradiance,
                const CoatExchange& coats = {});

  /// Power that leaves patches and by the row sums reaches patches, minus the power that patches receive, over the
  /// emitted power, of the worst channel. 0 for exact form factors; 0 without emission.
  double error() const;

  /// The power, W, that patches receive too little in all, once an error of the irradiance is mended by adding
  /// `missing`, W/m2. Shape: [n].
  Spectrum missing_power(const SpectrumField& missing) const;

 private:
  const std::vector<double> areas_;  ///< See receiving_areas().
  const SpectrumField& reflectance_;
  const SpectrumField row_sums_;
  Spectrum emitted_, excess_;  ///< W.
};

}  // namespace patchlight

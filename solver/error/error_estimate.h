#pragma once
#include "pipeline/model/energy_field.h"
#include "pipeline/model/patch_set.h"
#include "solver/error/consistency.h"
#include "solver/linear/irradiance_filter.h"

namespace patchlight {

/// A solution and its deviation: half the difference between its two sample sets, W/m2.
struct SampledSolution {
  struct Filtered {
    const IrradianceFilter* filter;
    const SpectrumField* deviation;  ///< [n] Before filtering.
  };

  SpectrumField irradiance;  ///< [n] W/m2, direct and indirect.
  SpectrumField deviation;   ///< [n] Of the unfiltered components.
  std::vector<Filtered> filtered;
  SpectrumField residual;  ///< [n] W/m2, of the linear system.
};

/// Estimates a solution's errors: error, error_bound, error_residual, error_local, error_local_estimate and deviation.
/// The bounds hold with a probability of 95%.
///
/// Sampling: by the wild bootstrap (Wu 1986, Liu 1988). The patches' deviations with random signs are errors as likely
/// as the true ones; solving the system for them adds the error that reaches other patches. The energy balance shows
/// how much light the solution lacks in all, which random signs may miss. The linear system's residual: the system is
/// solved for it alike.
EnergyField::Estimate estimate_error(const PatchSet& scene, const FormFactorRows& rows, const Scattering& scattering,
                                     const std::vector<double>& areas, const SampledSolution& solution,
                                     const EnergyBalance& balance);

}  // namespace patchlight

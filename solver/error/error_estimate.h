#pragma once
#include "pipeline/model/energy_field.h"
#include "pipeline/model/patch_set.h"
#include "solver/linear/irradiance_filter.h"

namespace patchlight {

/// A solution and its deviation: half the difference between its two sample sets, W/m2.
struct SampledSolution {
  struct Filtered {
    const IrradianceFilter* filter;
    SpectrumField deviation;  ///< [n] Before filtering.
  };

  SpectrumField irradiance;  ///< [n] W/m2, direct and indirect.
  SpectrumField deviation;   ///< [n] Of the unfiltered components.
  std::vector<Filtered> filtered;
  double residual = 0.0;  ///< Of the linear system.
};

/// Estimates a solution's error by the wild bootstrap (Wu 1986, Liu 1988): the patches' deviations with random signs
/// are errors as likely as the true ones; solving the system for them adds the error that reaches other patches.
/// The bound holds with a probability of 95% and includes the linear system's residual.
EnergyField::Estimate estimate_error(const PatchSet& scene, const FormFactorRows& rows,
                                     const SpectrumField& reflectance, const std::vector<double>& areas,
                                     const SampledSolution& solution);

}  // namespace patchlight

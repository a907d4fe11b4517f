#pragma once
#include "pipeline/model/energy_field.h"
#include "pipeline/model/patch_set.h"
#include "solver/linear/irradiance_filter.h"

namespace patchlight {

/// What a solve found, and how far half its samples are from it: half the difference of the halves, W/m2.
struct SampledSolution {
  struct Filtered {
    const IrradianceFilter* filter;
    SpectrumField deviation;  ///< [n] Before the filter.
  };

  SpectrumField irradiance;  ///< [n] W/m2, direct and indirect.
  SpectrumField deviation;   ///< [n] Of what no filter went over.
  std::vector<Filtered> filtered;
  double residual = 0.0;  ///< Of the linear system.
};

/// Estimates a solution's error: every patch's deviations, each with a sign of its own at random, are errors as likely
/// as the true ones; solved for, they tell what reaches other patches too (the wild bootstrap: Wu 1986, Liu 1988).
/// The bound is that of 19 of 20, with what the residual leaves.
EnergyField::Estimate estimate_error(const PatchSet& scene, const FormFactorRows& rows,
                                     const SpectrumField& reflectance, const std::vector<double>& areas,
                                     const SampledSolution& solution);

}  // namespace patchlight

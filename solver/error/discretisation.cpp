#include "solver/error/discretisation.h"

#include <cmath>

#include "solver/error/error_propagation.h"
#include "solver/error/reflected_errors.h"
#include "solver/form_factors/row_scattering.h"

namespace patchlight {

namespace {

constexpr double kDisplayError = 1.2;  // the display solution lacks a part of the error itself
constexpr double kMaxRatio = 0.95;     // of an error after these reflections to that before
constexpr double kLocalLevel = 0.95;

/// Adds what further reflections bring to an error that holds up to `reflections` of them, as a geometric series.
void add_further_reflections(const ErrorPropagation& propagation, int reflections, SpectrumField& error) {
  SpectrumField reflected = error;
  for (int k = 0; k < reflections; ++k) reflected = propagation.gather(reflected);
  const double before = propagation.norm(error);
  if (before == 0) return;
  const double ratio = std::min(propagation.norm(reflected) / before, kMaxRatio);
  for (std::size_t i = 0; i < error.size(); ++i) error[i] += reflected[i] * Spectrum(1 / (1 - ratio));
}

}  // namespace

void add_discretisation_error(const PatchSet& scene, const Transport& transport, const SpectrumField& difference,
                              int reflections, EnergyField& energy) {
  const Scattering scattering = row_scattering(scene, transport.rays > 0);
  SpectrumField irradiance(scene.patches.size()), error = difference;
  std::vector<double> areas;
  for (const Patch& patch : scene.patches) areas.push_back(patch.covered_area());
  for (const EnergyField::Group& group : energy.groups)
    for (std::size_t i = 0; i < irradiance.size(); ++i)
      irradiance[i] += Spectrum(group.direct[i]) + Spectrum(group.indirect[i]);
  EnergyField::Estimate& estimate = *energy.estimate;
  const ReflectedErrors errors(scene, scattering.albedo, areas, irradiance);
  for (std::size_t i = 0; i < error.size(); ++i) {
    const double square = errors.square_at(i, error[i]), by_sampling = estimate.deviation[i].length2();
    error[i] *= Spectrum(square > by_sampling ? std::sqrt(1 - by_sampling / square) : 0.0);
  }
  const FormFactorRows rows(transport, scene.sky_cells());
  add_further_reflections(ErrorPropagation(rows, scattering, areas), reflections, error);
  const double norm = errors.squared_norm(irradiance);
  if (norm == 0) return;
  estimate.error_patches = kDisplayError * std::sqrt(errors.squared_norm(error) / norm);
  add(error, irradiance);  // where patches leak, the light that there should be is the smaller by far
  const double local =
      kDisplayError * ReflectedErrors(scene, scattering.albedo, areas, irradiance).percentile(error, kLocalLevel);
  estimate.error = std::hypot(estimate.error, estimate.error_patches);
  estimate.error_bound = std::hypot(estimate.error_bound, estimate.error_patches);
  estimate.error_local = std::hypot(estimate.error_local, local);
  estimate.error_local_estimate = std::hypot(estimate.error_local_estimate, local);
}

}  // namespace patchlight

#include "solver/error/error_warnings.h"

#include <fmt/format.h>

#include "pipeline/job/more_samples.h"

namespace patchlight {

namespace {

constexpr double kMaxBound = 0.05, kMaxBalance = 0.01;
constexpr double kMainPart = 0.7;  // of the error, from which its cause is the first to mend

}  // namespace

std::vector<std::string> error_warnings(const SolveConfig& config, const EnergyField::Estimate& estimate) {
  std::vector<std::string> warnings;
  const bool by_patches = estimate.error_patches > kMainPart * estimate.error;
  const bool by_residual = estimate.error_residual > 0.5 * estimate.error;
  const auto mend = [&](double factor) {
    return by_residual ? fmt::format("lower solve.tolerance (now {})", config.tolerance) : more_samples(config, factor);
  };
  const double most = config.error_target > 0 ? config.error_target : kMaxBound;
  if (estimate.error_bound > most && (by_patches || config.error_target == 0))
    warnings.push_back(fmt::format("the error may reach {:.2g}%: {}", 100 * estimate.error_bound,
                                   by_patches ? "the patches are too coarse for the light; lower import.patch_area"
                                              : mend(estimate.error_bound / most)));
  if (estimate.balance > kMaxBalance && config.error_target == 0)
    warnings.push_back(fmt::format("the energy balance is {:.2g}% off: {}", 100 * estimate.balance,
                                   mend(estimate.balance / kMaxBalance)));
  return warnings;
}

}  // namespace patchlight

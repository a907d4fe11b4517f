#include "solver/error/error_propagation.h"

#include <algorithm>
#include <cmath>

#include "pipeline/stage/progress.h"
#include "solver/linear/parallel_rows.h"

namespace patchlight {

namespace {

constexpr double kTolerance = 0.05;
constexpr double kMaxUnsolved = 0.1;  // part of a propagated error that may be left out, at most
constexpr double kMinTolerance = 1e-6;
constexpr int kMaxIterations = 500;

}  // namespace

ErrorPropagation::ErrorPropagation(const FormFactorRows& rows, const Scattering& scattering,
                                   const std::vector<double>& areas)
    : rows_(rows), scattering_(scattering), areas_(areas) {
  double largest = 0;
  for (const Spectrum& rho : scattering.albedo)
    for (int k = 0; k < 3; ++k) largest = std::max(largest, rho.c[k]);
  amplification_ = 1 / std::max(1 - largest, 1e-6);
}

SpectrumField ErrorPropagation::propagate(const SpectrumField& error) const {
  SpectrumField propagated(areas_.size());
  solve(gather(error), kTolerance, propagated);
  return propagated;
}

SpectrumField ErrorPropagation::propagate_safely(const SpectrumField& error, double negligible) const {
  const SpectrumField source = gather(error);
  SpectrumField propagated(areas_.size());
  const double size = norm(source);
  for (double tolerance = kTolerance; size > 0 && tolerance > kMinTolerance; tolerance *= 0.1) {
    const double left = amplification_ * solve(source, tolerance, propagated) * size;
    if (left <= std::max(kMaxUnsolved * norm(propagated), negligible)) break;
  }
  return propagated;
}

SpectrumField ErrorPropagation::gather(const SpectrumField& error) const {
  SpectrumField gathered(areas_.size());
  const FormFactorRows::Field field{&error, {&gathered}};
  rows_.gather({&field, 1}, &scattering_, FormFactorRows::Precision::single);
  return gathered;
}

double ErrorPropagation::solve(const SpectrumField& source, double tolerance, SpectrumField& x) const {
  std::vector<SpectrumField> sources{source}, solutions;
  solutions.push_back(std::move(x));
  const double residual = solve_irradiance(rows_, scattering_, areas_, sources, tolerance, kMaxIterations, solutions,
                                           [](double) { Progress::check_interrupted(); })[0]
                              .residual;
  x = std::move(solutions[0]);
  return residual;
}

double ErrorPropagation::norm(const SpectrumField& field) const {
  const auto [square] = sums_over_rows<1>(
      field.size(), [&](std::size_t i) { return std::array{field[i] * field[i] * Spectrum(areas_[i])}; });
  return std::sqrt(square.sum());
}

}  // namespace patchlight

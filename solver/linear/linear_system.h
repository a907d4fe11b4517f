#pragma once
#include <functional>
#include <string>
#include <vector>

#include "solver/linear/form_factor_rows.h"
#include "solver/linear/spectrum.h"

namespace patchlight {

/// Throws: Error (bad_data): a light group's irradiance is too large for single precision.
[[noreturn]] void throw_overflow(const std::string& group);

/// Converts to single precision; negative values become 0. Throws: Error (bad_data) naming the light group if a value
/// is too large.
std::vector<Color> to_colors(const SpectrumField& field, const std::string& group);

/// Result of an iterative solve.
struct LinearSolve {
  int iterations = 0;
  double residual = 0.0;          ///< Norm of the residual over that of the source, of the worst channel: the
                                  ///< least of all iterations; 0 without a source.
  std::vector<double> residuals;  ///< Before each iteration and after the last.
};

/// Solves x = source + F M x, where M is `scattering`, for the irradiance x of each source by BiCGSTAB (van der Vorst
/// 1992), all channels and up to RadiosityTable::kMaxFields sources together, in the inner product weighted by `areas`.
/// `x` holds the initial guesses. `step` is called with the largest residual before each iteration.
/// The result depends neither on the number of threads nor on the other sources.
std::vector<LinearSolve> solve_irradiance(const FormFactorRows& rows, const Scattering& scattering,
                                          const std::vector<double>& areas, const std::vector<SpectrumField>& sources,
                                          double tolerance, int max_iterations, std::vector<SpectrumField>& x,
                                          const std::function<void(double)>& step);

}  // namespace patchlight

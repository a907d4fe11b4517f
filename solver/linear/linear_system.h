#pragma once
#include <functional>
#include <string>
#include <vector>

#include "solver/linear/form_factor_rows.h"
#include "solver/linear/spectrum.h"

namespace patchlight {

/// For files: negative values count as 0. Throws: Error (bad_data), naming the light group, if one is too large.
std::vector<Color> to_colors(const SpectrumField& field, const std::string& group);

/// How solving a linear system ended.
struct LinearSolve {
  int iterations = 0;
  double residual = 0.0;  ///< Norm of what is left over that of the source, of the worst channel; 0 without a source.
  std::vector<double> residuals;  ///< Before each iteration and after the last.
};

/// Solves x = source + F (reflectance x) for the irradiance x of each source by BiCGSTAB (van der Vorst 1992), all
/// channels and up to RadiosityTable::kMostFields sources side by side, in the inner product weighted by `areas`.
/// Starts from the x given. `step` is called with the worst residual before each iteration.
/// The same for any number of threads, and whatever stands beside a source.
std::vector<LinearSolve> solve_irradiance(const FormFactorRows& rows, const SpectrumField& reflectance,
                                          const std::vector<double>& areas, const std::vector<SpectrumField>& sources,
                                          double tolerance, int max_iterations, std::vector<SpectrumField>& x,
                                          const std::function<void(double)>& step);

}  // namespace patchlight

#pragma once
#include "solver/linear/linear_system.h"

namespace patchlight {

/// How errors of the irradiance of patches reach other patches: p = F M (e + p) for an error e and the scattering M. At
/// high reflectance p is many times e.
class ErrorPropagation {
 public:
  ErrorPropagation(const FormFactorRows& rows, const Scattering& scattering, const std::vector<double>& areas);

  /// The propagated part p of an error, solved to a residual of 5%. Shape: [n].
  SpectrumField propagate(const SpectrumField& error) const;

  /// The same, solved until the residual, however amplified, would change its norm by less than 10% or less than
  /// `negligible`.
  SpectrumField propagate_safely(const SpectrumField& error, double negligible) const;

  /// What errors bring to other patches by one reflection: F rho e. Shape: [n].
  SpectrumField gather(const SpectrumField& error) const;

  /// Area-weighted L2 norm of all channels together.
  double norm(const SpectrumField& field) const;

 private:
  /// Improves `x`; returns the residual, relative to the source.
  double solve(const SpectrumField& source, double tolerance, SpectrumField& x) const;

  const FormFactorRows& rows_;
  const Scattering& scattering_;
  const std::vector<double>& areas_;
  double amplification_;  ///< Upper bound of the norm of (1 - F rho)^-1: rows of F add up to at most 1.
};

}  // namespace patchlight

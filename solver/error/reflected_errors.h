#pragma once
#include "pipeline/model/patch_set.h"
#include "solver/linear/irradiance_filter.h"

namespace patchlight {

/// Measures errors of a solution's irradiance by what is reflected of them, over the patches that do not emit.
class ReflectedErrors {
 public:
  /// `irradiance`: of the solution, W/m2, direct and indirect. Shape: [n].
  ReflectedErrors(const PatchSet& scene, const SpectrumField& reflectance, const std::vector<double>& areas,
                  const SpectrumField& irradiance)
      : scene_(scene), reflectance_(reflectance), areas_(areas), irradiance_(irradiance) {}

  bool is_counted(std::size_t i) const { return scene_.patches[i].emission == Color(0.0f); }

  /// Square of what patch i reflects of an irradiance, all channels together, W2/m4.
  double square_at(std::size_t i, const Spectrum& irradiance) const {
    const Spectrum reflected = reflectance_[i] * irradiance;
    return (reflected * reflected).sum();
  }

  /// Area-weighted sum of the squares.
  double squared_norm(const SpectrumField& error) const;

  /// Counts a filter's bias as a part of all local errors: on each primitive its mean, relative to the solution.
  void add_bias(const IrradianceFilter& filter);

  /// The value that the local relative errors stay below on the part `level`, in [0,1], of the area that reflects
  /// and is not black in the solution.
  double percentile(const SpectrumField& error, double level) const;

 private:
  /// Square of the reflected light of a black patch.
  double squared_black() const;

  const PatchSet& scene_;
  const SpectrumField& reflectance_;
  const std::vector<double>& areas_;
  const SpectrumField& irradiance_;
  std::vector<double> squared_bias_;  ///< [primitives] Relative; empty: none.
};

}  // namespace patchlight

#pragma once
#include "pipeline/optics/sampling/patch_lookup.h"
#include "solver/linear/linear_system.h"

namespace patchlight {

/// Smooths sampled irradiance over the patches of a primitive, where that brings it nearer to the truth.
///
/// Filters fit a polynomial of second degree to a window of patches (Savitzky and Golay 1964), which keeps slopes and
/// curvature. Which window, if any, is chosen patch by patch: from two independent halves of the samples follow,
/// without bias, the mean square of what a filter bends and of the noise that it leaves (as in Rousselle, Knaus and
/// Zwicker 2012).
class IrradianceFilter {
 public:
  /// Chooses for `irradiance` [n] and its deviation (half the difference of the halves), weighted by `reflectance`.
  /// Where `lit` [n] is zero nothing is brought in.
  IrradianceFilter(const PatchLookup& lookup, std::size_t primitives, const SpectrumField& irradiance,
                   const SpectrumField& deviation, const SpectrumField& reflectance, const SpectrumField& lit);

  /// Any field of the same samples, filtered. Linear. Shape: [n].
  SpectrumField apply(const SpectrumField& field) const;

  /// What the filter bends a patch's reflected irradiance by, all channels together, W2/m4.
  struct Bias {
    double square = 0.0;    ///< Estimated without bias, so that of a single patch it may be negative.
    double variance = 0.0;  ///< Of this estimate.
  };
  const Bias& bias(std::size_t i) const { return bias_[i]; }

  /// How many patches share an error about patch i.
  double correlated(std::size_t i) const;

 private:
  struct Grid {
    std::int32_t first;
    int nu, nv;

    int patches() const { return nu * nv; }
  };

  void choose(const Grid& grid, const SpectrumField& irradiance, const SpectrumField& deviation,
              const SpectrumField& reflectance, const SpectrumField& lit);

  std::vector<Grid> grids_;
  std::vector<std::uint8_t> choice_;  ///< [n] Index of a window's width; 0: none.
  std::vector<Bias> bias_;
};

}  // namespace patchlight

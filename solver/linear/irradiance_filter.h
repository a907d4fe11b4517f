#pragma once
#include "solver/linear/filter_grids.h"
#include "solver/linear/linear_system.h"

namespace patchlight {

/// Smooths sampled irradiance over the patches of a primitive, or of quads that continue each other, where that reduces
/// the mean squared error.
///
/// The filters fit a polynomial of second degree to a window of patches (Savitzky and Golay 1964), which keeps
/// gradients and curvature. Each patch has its own window, or none: two independent sample sets give unbiased estimates
/// of a filter's squared bias and remaining variance (as in Rousselle, Knaus and Zwicker 2012). Windows do not reach
/// beyond edges on which other surfaces stand, nor into cut cells.
class IrradianceFilter {
 public:
  /// Chooses windows for `irradiance` [n] with its `deviation`, half the difference of its sample sets, both weighted
  /// by `reflectance`. Patches where `lit` [n] is zero are not filtered.
  IrradianceFilter(const std::vector<FilterGrid>& grids, const SpectrumField& irradiance,
                   const SpectrumField& deviation, const SpectrumField& reflectance, const SpectrumField& lit);

  /// Filters a field of the same samples. Linear. Shape: [n].
  SpectrumField apply(const SpectrumField& field) const;

  /// Bias of a patch's filtered reflected irradiance, all channels together, W2/m4.
  struct Bias {
    double square = 0.0;    ///< Unbiased estimate; may be negative for a single patch.
    double variance = 0.0;  ///< Of the estimate.
  };
  const Bias& bias(std::size_t i) const { return bias_[i]; }

  /// Effective number of patches around patch i whose errors are correlated.
  double correlated_patches(std::size_t i) const;

 private:
  void choose(const FilterGrid& grid, const SpectrumField& irradiance, const SpectrumField& deviation,
              const SpectrumField& reflectance, const SpectrumField& lit);

  std::vector<FilterGrid> grids_;
  std::vector<std::uint8_t> choice_;  ///< [n] Index of the window's width; 0: none.
  std::vector<Bias> bias_;
};

}  // namespace patchlight

#pragma once
#include "solver/linear/spectrum.h"

namespace patchlight {

/// A filter's value of something sampled, and of its noise: half the difference of two sample sets.
struct Filtered {
  Spectrum value, noise;
};

/// Sum of the squares of the channels, each times a weight.
inline double weighted_square(const Spectrum& s, const Spectrum& weight) {
  return (s * s * weight * weight).sum();
}

/// Unbiased estimate of the squared error of a filter minus that of a narrower one: of the change of its squared bias
/// plus that of its variance (as in Rousselle, Knaus and Zwicker 2012).
inline double error_increase(const Filtered& narrow, const Filtered& wide, const Spectrum& weight = Spectrum(1.0)) {
  return weighted_square(wide.value - narrow.value, weight) - weighted_square(wide.noise - narrow.noise, weight) +
         weighted_square(wide.noise, weight) - weighted_square(narrow.noise, weight);
}

}  // namespace patchlight

#pragma once
#include <algorithm>
#include <cmath>

#include "pipeline/model/math.h"

namespace patchlight {

/// Form factor of a sphere, whose centre has this cosine to the normal; `ratio`: squared sine of its angular radius.
inline double spherical_form_factor(double cosine, double ratio) {
  if (cosine * cosine >= ratio) return ratio * std::max(cosine, 0.0);
  const double sine = std::sqrt(1 - cosine * cosine);
  const double x = std::sqrt(1 / ratio - 1), y = -x * cosine / sine;
  const double z = sine * std::sqrt(std::max(0.0, 1 - y * y));
  return std::max(0.0, ((cosine * std::acos(std::clamp(y, -1.0, 1.0)) - x * z) * ratio + std::atan(z / x)) / kPi);
}

}  // namespace patchlight

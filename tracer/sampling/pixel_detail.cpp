#include "tracer/sampling/pixel_detail.h"

namespace patchlight {

namespace {

// Variation above which more samples pay off. Below, radiance is nearly linear and the initial samples are stratified.
constexpr float kMinContrast = 0.12f;
constexpr float kMinNormalDifference = 0.2f;

}  // namespace

float PixelDetail::Range::contrast() const {
  float largest = 0;
  for (int k = 0; k < 3; ++k)
    if (high[k] > low[k] && high[k] + low[k] > 0) largest = std::max(largest, (high[k] - low[k]) / (high[k] + low[k]));
  return largest;
}

PixelDetail::Level PixelDetail::level() const {
  if (lowest_ > highest_) return Level::smooth;  // no paths
  if (lowest_ != highest_ || scattered_) return Level::edge;
  if (std::max(light_.contrast(), reflectance_.contrast()) > kMinContrast ||
      (normals_.high - normals_.low).length() > kMinNormalDifference)
    return Level::detail;
  return Level::smooth;
}

}  // namespace patchlight

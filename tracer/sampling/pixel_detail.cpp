#include "tracer/sampling/pixel_detail.h"

namespace patchlight {

namespace {

// Contrast from which on more samples pay. What is below it bends little, and the first samples are spread evenly.
constexpr float kSomeContrast = 0.12f;
constexpr float kSomeTurn = 0.2f;  // between normals

}  // namespace

float PixelDetail::Range::contrast() const {
  float most = 0;
  for (int k = 0; k < 3; ++k)
    if (high[k] > low[k] && high[k] + low[k] > 0) most = std::max(most, (high[k] - low[k]) / (high[k] + low[k]));
  return most;
}

PixelDetail::Level PixelDetail::level() const {
  if (lowest_ > highest_) return Level::none;  // no paths
  if (lowest_ != highest_ || scattered_) return Level::edge;
  if (std::max(light_.contrast(), reflectance_.contrast()) > kSomeContrast ||
      (normals_.high - normals_.low).length() > kSomeTurn)
    return Level::some;
  return Level::none;
}

}  // namespace patchlight

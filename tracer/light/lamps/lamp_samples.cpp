#include "tracer/light/lamps/lamp_samples.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/random.h"

namespace patchlight {

int probe_count(float share) {
  return share < 0.1f ? 1 : share < 0.4f ? 2 : 4;
}

int ray_count(float share, int samples, const Visibility& visibility) {
  constexpr float kRaysPerSample = 8;  // for a single lamp that is half hidden
  constexpr float kMinVisible = 0.05f, kMinRays = 4;
  const float visible = std::max(visibility.visible_fraction(), kMinVisible);
  return int(std::max(kMinRays, kRaysPerSample * float(samples) * share * 2 * std::sqrt(visible * (1 - visible))));
}

Vec2f probe_place(int x, int y, int k, std::uint64_t shift) {
  constexpr float kDriftX = 0.0137f, kDriftY = 0.0071f;  // of the lattice of 3 x 3 pixels, from pixel to pixel
  const Vec2f base = kronecker2(std::uint64_t(k), shift);
  const float u = base.x + float(x % 9) / 3 + float(y % 9) / 9 + kDriftX * float(x) + kDriftY * float(y);
  const float v = base.y + float(y % 9) / 3 + float(x % 9) / 9 + kDriftY * float(x) - kDriftX * float(y);
  return {u - std::floor(u), v - std::floor(v)};
}

float visible_factor(float unoccluded, const LightSamples& samples, const Visibility& visibility) {
  return float(visibility.mostly_visible() ? samples.estimate_from_hidden(unoccluded)
                                           : samples.estimate_from_visible());
}

}  // namespace patchlight

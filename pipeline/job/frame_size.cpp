#include "pipeline/job/frame_size.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

constexpr double kPixels = 640 * 480;
constexpr double kTolerance = 0.025;  // of the height
constexpr double kSameError = 1e-6;   // of aspect ratios, by the rounding of files

int even(double x) {
  return std::max(2, 2 * int(std::lround(x / 2)));
}

}  // namespace

std::array<int, 2> frame_size(const TraceConfig& config, const Camera& camera) {
  if (config.resolution) return *config.resolution;
  const double wanted = std::sqrt(kPixels / camera.aspect);
  std::array<int, 2> best{};
  double least = 0;
  const auto consider = [&](int height) {
    const std::array<int, 2> size{even(camera.aspect * height), height};
    const double error = std::abs(std::log(double(size[0]) / size[1] / camera.aspect));
    if (best[0] > 0 && error > least - kSameError) return;
    best = size;
    least = error;
  };
  const int middle = even(wanted), most = int(kTolerance * wanted);
  consider(middle);
  for (int step = 2; step <= most; step += 2)
    for (const int height : {middle + step, middle - step})
      if (std::abs(height - wanted) <= kTolerance * wanted) consider(height);
  return best;
}

}  // namespace patchlight

#include "solver/direct/mean_form_factor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/optics/sampling/random.h"

namespace patchlight {

namespace {

// Distance in patch sizes from which the form factor at the centre equals the mean over the patch within 1e-4.
constexpr double kFarForCentre = 30.0;
constexpr double kFarForTwo = 5.0;       // from which quadrature with 2 x 2 points is as good
constexpr double kFarForFour = 1.5;      // up to which quadrature with 4 x 4 points is checked
constexpr double kMaxDifference = 0.02;  // relative, between 2 x 2 and 4 x 4 points, for which the latter are enough
constexpr int kMaxDepth = 5;             // of quarters of quarters
constexpr int kPointsPerFacet = 4, kMostPoints = 64;  // of a cluster

class Quadrature {
 public:
  Quadrature(const DirectLight& light, const PatchSampler& sampler) : light_(light), sampler_(sampler) {}

  /// Over a square of the unit square from (x,y).
  double two(float x, float y, float size) const {
    return integrate(std::array{0.2113248654f, 0.7886751346f}, std::array{0.5, 0.5}, x, y, size);
  }
  double four(float x, float y, float size) const {
    return integrate(std::array{0.0694318442f, 0.3300094782f, 0.6699905218f, 0.9305681558f},
                     std::array{0.1739274226, 0.3260725774, 0.3260725774, 0.1739274226}, x, y, size);
  }
  double adaptive(float x, float y, float size, int depth) const {
    const double mean = four(x, y, size);
    if (depth == kMaxDepth || std::abs(two(x, y, size) - mean) <= kMaxDifference * mean) return mean;
    const float half = 0.5f * size;
    double sum = 0;
    for (int k = 0; k < 4; ++k) sum += adaptive(x + (k % 2 ? half : 0.0f), y + (k / 2 ? half : 0.0f), half, depth + 1);
    return 0.25 * sum;
  }

 private:
  template <std::size_t n>
  double integrate(const std::array<float, n>& places, const std::array<double, n>& weights, float x, float y,
                   float size) const {
    double sum = 0;
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) {
        const SurfacePoint point = sampler_(x + size * places[i], y + size * places[j]);
        sum += weights[i] * weights[j] * light_.form_factor(point.position, point.normal);
      }
    return sum;
  }

  const DirectLight& light_;
  const PatchSampler& sampler_;
};

/// Over points that are spread evenly along the facets of a cluster, at most kMostPoints.
double mean_over_facets(const DirectLight& light, const Patch& cluster, const PatchSampler& sampler) {
  const int count = std::min(kPointsPerFacet * cluster.facets, kMostPoints);
  double sum = 0;
  for (int k = 0; k < count; ++k) {
    const Vec2f at = kronecker2(std::uint64_t(k), 0);
    const SurfacePoint point = sampler((float(k) + 0.5f) / float(count), at.y);
    sum += light.form_factor(point.position, point.normal);
  }
  return sum / count;
}

}  // namespace

double mean_form_factor(const DirectLight& light, const Patch& patch, const PatchSampler& sampler,
                        const VisibleDensity* density) {
  if (patch.facets > 0) return mean_over_facets(light, patch, sampler);
  const double distance = light.distance(patch.center) / std::sqrt(patch.area);
  if (distance > kFarForCentre) return light.form_factor(patch.center, patch.normal);
  if (density) {
    constexpr int kSide = 8;
    double sum = 0;
    for (int k = 0; k < kSide * kSide; ++k) {
      const Vec2f at = (*density)(Vec2f(float(k % kSide) + 0.5f, float(k / kSide) + 0.5f) / float(kSide));
      const SurfacePoint point = sampler(at.x, at.y);
      sum += light.form_factor(point.position, point.normal);
    }
    return sum / (kSide * kSide);
  }
  const Quadrature quadrature(light, sampler);
  if (distance > kFarForTwo) return quadrature.two(0, 0, 1);
  return distance > kFarForFour ? quadrature.four(0, 0, 1) : quadrature.adaptive(0, 0, 1, 0);
}

}  // namespace patchlight

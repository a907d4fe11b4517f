#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight::test {

using Corners = std::array<Vec3d, 4>;

/// Lambert's form factor from a surface point to a polygon that lies above its horizon and faces it.
inline double point_factor(const SurfacePoint& at, const Corners& corners) {
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3d a = (corners[k] - at.position).normalized(), b = (corners[(k + 1) % 4] - at.position).normalized();
    const Vec3d cross = b % a;
    if (cross.length() > 0) sum += std::atan2(cross.length(), a ^ b) * (cross.normalized() ^ Vec3d(at.normal));
  }
  return sum / (2 * kPi);
}

/// Mean of point_factor() over a patch, summed over the polygons that face each point.
inline double patch_factor(const PatchSet& scene, const Patch& patch, const std::vector<Corners>& polygons) {
  constexpr int kPoints = 48;
  const PatchSampler sample(scene.primitives, patch);
  double sum = 0;
  for (int k = 0; k < kPoints * kPoints; ++k) {
    const SurfacePoint at = sample((float(k % kPoints) + 0.5f) / kPoints, (float(k / kPoints) + 0.5f) / kPoints);
    for (const Corners& c : polygons)
      if ((((c[2] - c[0]) % (c[3] - c[1])) ^ (at.position - c[0])) > 0) sum += point_factor(at, c);
  }
  return sum / (kPoints * kPoints);
}

/// Makes the last primitive, which must have more than 64 patches, emit unevenly by a millionth, so that its light is
/// gathered with the form factors and not sampled explicitly.
inline void gathered_light(PatchSet& scene) {
  scene.patches.back().emission *= 1.000001f;
}

}  // namespace patchlight::test

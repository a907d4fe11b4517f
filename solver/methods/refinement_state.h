#pragma once
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// Light group while progressive refinement solves it. Fields have shape [n].
struct RefinedGroup {
  /// Irradiance of explicit_emitters(), of further_emitters(), and of other emitters and the environment, W/m2.
  std::vector<Vec3d> direct, sampled, gathered;
  std::vector<Vec3d> indirect;  ///< Irradiance, W/m2.
  std::vector<Vec3d> unshot;    ///< Reflected and not shot yet, W/m2.
  double emitted = 0.0;         ///< W, sum of channels; of lights and the environment, the power that arrives.
  double source_norm = 0.0;     ///< Of the reflected direct light rho D.
  double unshot_norm = 0.0;
  Vec3d ambient{0.0};  ///< Estimated mean irradiance by the unshot light, W/m2.
};

/// Every k-th value and the last, about 500 at most.
inline std::vector<double> thinned(const std::vector<double>& values) {
  constexpr std::size_t kMaxValues = 500;
  const std::size_t step = values.size() / kMaxValues + 1;
  std::vector<double> result;
  for (std::size_t i = 0; i + 1 < values.size(); i += step) result.push_back(values[i]);
  if (!values.empty()) result.push_back(values.back());
  return result;
}

}  // namespace patchlight

#include "pipeline/job/more_samples.h"

#include <fmt/format.h>

#include <cmath>

namespace patchlight {

std::string more_samples(const SolveConfig& config, double factor) {
  if (config.form_factors == "hemicube")
    return fmt::format("raise solve.hemicube_resolution (now {})", config.hemicube_resolution);
  const double rays = std::ceil(factor * factor * config.rays / 32) * 32;
  return fmt::format("raise solve.rays (now {}) to about {:.0f}", config.rays, rays);
}

}  // namespace patchlight

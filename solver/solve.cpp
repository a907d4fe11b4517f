#include "solver/solve.h"

#include <fmt/format.h>

#include <chrono>

#include "pipeline/files/job_check.h"
#include "pipeline/files/key.h"
#include "solver/hemicube.h"
#include "solver/progressive_refinement.h"
#include "solver/ray_form_factors.h"

namespace patchlight {

namespace {

std::unique_ptr<FormFactorSource> make_form_factors(const PatchSet& scene, const SolveConfig& config) {
  if (config.form_factors == "hemicube")
    return std::make_unique<HemicubeFormFactors>(scene, config.hemicube_resolution, std::uint64_t(config.seed));
  return std::make_unique<RayFormFactors>(scene, std::uint64_t(config.seed));
}

}  // namespace

EnergyField solve(const PatchSet& scene, const SolveConfig& config, Progress& progress) {
  check_available(config);
  const auto start = std::chrono::steady_clock::now();
  if (scene.light_groups.empty())
    progress.warning("nothing in the scene emits light: all is black; give a material an emission");
  EnergyField energy = progressive_refinement(scene, config, *make_form_factors(scene, config), progress);
  energy.key = energy_key(scene.key, config);
  energy.patches_key = scene.key;
  energy.method = config.method;
  energy.form_factors = config.form_factors;
  energy.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::string rays = energy.rays > 0 ? fmt::format(" of {:.3g} million rays", double(energy.rays) * 1e-6) : "";
  progress.note(fmt::format("{} patches, {} shots{}, residual {:.2g}, {:.2f} s", scene.patches.size(),
                            energy.iterations, rays, energy.residual, energy.seconds));
  return energy;
}

}  // namespace patchlight

#include "solver/solve.h"

#include <fmt/format.h>

#include <chrono>

#include "pipeline/files/job_check.h"
#include "pipeline/files/key.h"
#include "solver/hemicube.h"
#include "solver/matrix_solver.h"
#include "solver/progressive_refinement.h"
#include "solver/ray_form_factors.h"

namespace patchlight {

namespace {

std::unique_ptr<FormFactorSource> make_form_factors(const PatchSet& scene, const SolveConfig& config) {
  if (config.form_factors == "hemicube")
    return std::make_unique<HemicubeFormFactors>(scene, config.hemicube_resolution, std::uint64_t(config.seed));
  return std::make_unique<RayFormFactors>(scene, std::uint64_t(config.seed));
}

std::string summary(const PatchSet& scene, const EnergyField& energy) {
  std::string text = fmt::format("{} patches, {} {}, ", scene.patches.size(), energy.iterations,
                                 energy.method == "matrix" ? "iterations" : "shots");
  if (energy.rays > 0) text += fmt::format("{:.3g} million rays, ", double(energy.rays) * 1e-6);
  text += fmt::format("residual {:.2g}, ", energy.residual);
  if (energy.estimate)
    text += fmt::format("error {:.2g}% (below {:.2g}% in 19 of 20), balance {:.2g}%, reciprocity {:.2g}%, ",
                        100 * energy.estimate->error, 100 * energy.estimate->error_bound,
                        100 * energy.estimate->balance, 100 * energy.estimate->reciprocity);
  return text + fmt::format("{:.2f} s", energy.seconds);
}

}  // namespace

EnergyField solve(const PatchSet& scene, const SolveConfig& config, Transport& transport, Progress& progress) {
  check_available(config);
  const auto start = std::chrono::steady_clock::now();
  if (scene.light_groups.empty())
    progress.warning("nothing in the scene emits light: all is black; give a material an emission");
  EnergyField energy = config.method == "matrix"
                           ? solve_matrix(scene, config, transport, progress)
                           : progressive_refinement(scene, config, *make_form_factors(scene, config), progress);
  energy.key = energy_key(scene.key, config);
  energy.patches_key = scene.key;
  energy.method = config.method;
  energy.form_factors = config.form_factors;
  energy.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  progress.note(summary(scene, energy));
  return energy;
}

EnergyField solve(const PatchSet& scene, const SolveConfig& config, Progress& progress) {
  Transport transport;
  return solve(scene, config, transport, progress);
}

}  // namespace patchlight

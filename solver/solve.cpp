#include "solver/solve.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "pipeline/job/job_check.h"
#include "pipeline/job/stage_keys.h"
#include "solver/display/display_solution.h"
#include "solver/error/error_warnings.h"
#include "solver/form_factors/ray_form_factors.h"
#include "solver/hemicube/hemicube.h"
#include "solver/methods/matrix_solver.h"
#include "solver/methods/progressive_refinement.h"
#include "solver/progress/solve_parts.h"
#include "solver/transport/memory_need.h"
#include "solver/transport/transport_builder.h"

namespace patchlight {

namespace {

std::unique_ptr<FormFactorSource> make_form_factors(const PatchSet& scene, const SolveConfig& config) {
  if (config.form_factors == "hemicube")
    return std::make_unique<HemicubeFormFactors>(scene, config.hemicube_resolution, std::uint64_t(config.seed));
  return std::make_unique<RayFormFactors>(scene, std::uint64_t(config.seed));
}

/// Solves to smaller tolerances and with more and more rays a row until the error bound is below the target, or memory
/// runs out.
EnergyField solve_to_target(const PatchSet& scene, SolveConfig config, Transport& transport, Progress& progress) {
  constexpr int kMaxRays = 1 << 22;
  constexpr double kMaxResidualPart = 0.2;  // of the error bound; a smaller tolerance takes less time than more rays
  constexpr double kMinTolerance = 1e-9;
  constexpr double kMargin = 1.2;  // more rays than predicted, since a solve above the target must be repeated
  if (config.error_target > 0) config.tolerance = std::min(config.tolerance, config.error_target / 20);
  const bool has_rows = transport.key == transport_key(scene.geometry_key, config);
  std::int64_t cast = 0;
  for (int rays = has_rows && config.error_target > 0 ? std::max(config.rays, transport.rays) : config.rays;;) {
    EnergyField energy = solve_matrix(scene, config, rays, transport, progress);
    energy.rays = cast += energy.rays;
    const double bound = energy.estimate->error_bound;
    if (config.error_target == 0 || bound <= config.error_target) return energy;
    if (energy.estimate->error_residual > kMaxResidualPart * bound && config.tolerance > kMinTolerance) {
      config.tolerance *= 0.1;
      continue;
    }
    const double factor = std::clamp(kMargin * std::pow(bound / config.error_target, 2), 1.5, 8.0);
    const int more = int(std::min(factor * rays, double(kMaxRays)));
    if (more <= rays || memory_needed(scene, config, more) > memory_allowed(config)) {
      progress.warning(
          fmt::format("the error bound stays at {:.2g}%: more than {} rays a patch need more memory than "
                      "--memory allows, or solve.error_target ({}%) is too small for these patches",
                      100 * bound, rays, 100 * config.error_target));
      return energy;
    }
    progress.note(
        fmt::format("error below {:.2g}% with {} rays a patch: continuing with {} rays", 100 * bound, rays, more));
    rays = more;
  }
}

std::string summary(const PatchSet& scene, const EnergyField& energy) {
  std::string text = fmt::format("{} patches, {} {}, ", scene.patches.size(), energy.iterations,
                                 energy.method == "matrix" ? "iterations" : "shots");
  if (energy.rays > 0) text += fmt::format("{:.3g} million rays, ", double(energy.rays) * 1e-6);
  text += fmt::format("residual {:.2g}, ", energy.residual);
  if (energy.estimate)
    text += fmt::format(
        "error {:.2g}% (95% bound {:.2g}%), local error {:.2g}% (95% bound {:.2g}%), balance {:.2g}%, "
        "reciprocity {:.2g}%, ",
        100 * energy.estimate->error, 100 * energy.estimate->error_bound, 100 * energy.estimate->error_local_estimate,
        100 * energy.estimate->error_local, 100 * energy.estimate->balance, 100 * energy.estimate->reciprocity);
  return text + fmt::format("{:.2f} s", energy.seconds);
}

}  // namespace

EnergyField solve(const PatchSet& scene, const SolveConfig& config, Transport& transport, Progress& progress) {
  check_available(config);
  const auto start = std::chrono::steady_clock::now();
  if (scene.light_groups.empty())
    progress.warning(
        "nothing in the scene emits light, so the result is black: add a light or an emissive material to the scene, "
        "or "
        "set `materials.NAME.emission` or `environment.color` in the job");
  const auto is_passed = [&](const Primitive& p) { return lets_light_pass(scene, p); };
  if ((config.method != "matrix" || config.form_factors == "hemicube") &&
      std::ranges::any_of(scene.primitives, is_passed))
    progress.warning(
        "progressive refinement and hemicubes take surfaces that let light pass for wholly clear ones: set "
        "solve.method to matrix and solve.form_factors to rays");
  check_memory(scene, config);
  if (config.method != "matrix") begin_part(SolvePart::shots, config, progress);
  EnergyField energy = config.method == "matrix"
                           ? solve_to_target(scene, config, transport, progress)
                           : progressive_refinement(scene, config, *make_form_factors(scene, config), progress);
  if (config.display) add_display_solution(scene, config, transport, energy, progress);
  if (energy.estimate)
    for (const std::string& warning : error_warnings(config, *energy.estimate)) progress.warning(warning);
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

#include "solver/solve.h"

#include <fmt/format.h>

#include <chrono>

#include "pipeline/files/key.h"
#include "pipeline/model/error.h"
#include "solver/progressive_refinement.h"

namespace patchlight {

namespace {

void check_available(const SolveConfig& config) {
  const auto refuse = [](const std::string& value, const std::string& key, const std::string& mend) {
    throw Error(ExitCode::bad_config, "`" + value + "` is not available yet", key, mend);
  };
  if (config.method != "progressive") refuse(config.method, "solve.method", "use `progressive`");
  if (config.form_factors != "rays") refuse(config.form_factors, "solve.form_factors", "use `rays`");
  if (config.display) refuse("true", "solve.display", "use `false`");
}

}  // namespace

EnergyField solve(const PatchSet& scene, const SolveConfig& config, Progress& progress) {
  check_available(config);
  const auto start = std::chrono::steady_clock::now();
  if (scene.light_groups.empty())
    progress.warning("nothing in the scene emits light: all is black; give a material an emission");
  EnergyField energy = progressive_refinement(scene, config, progress);
  energy.key = energy_key(scene.key, config);
  energy.patches_key = scene.key;
  energy.method = config.method;
  energy.form_factors = config.form_factors;
  energy.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  progress.note(fmt::format("{} patches, {} shots, {:.3g} million rays, residual {:.2g}, {:.2f} s",
                            scene.patches.size(), energy.iterations, double(energy.rays) * 1e-6, energy.residual,
                            energy.seconds));
  return energy;
}

}  // namespace patchlight

#include "solver/methods/matrix_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "solver/error/consistency.h"
#include "solver/error/error_estimate.h"
#include "solver/linear/irradiance_filter.h"
#include "solver/methods/group_solution.h"
#include "solver/progress/solve_parts.h"
#include "solver/transport/transport_builder.h"

namespace patchlight {

namespace {

/// A sampled component of the irradiance, summed over the light groups; empty: no such light.
struct Component {
  SpectrumField irradiance, deviation;

  void add(const SpectrumField& more, const SpectrumField& more_deviation) {
    irradiance.resize(more.size());
    deviation.resize(more.size());
    patchlight::add(more, irradiance);
    patchlight::add(more_deviation, deviation);
  }
};

/// The components that are filtered, and their filters.
class FilteredComponents {
 public:
  FilteredComponents(const RadiositySystem& system, const std::vector<GroupSolution>& groups) {
    const std::size_t n = system.areas.size();
    reflected_ = {SpectrumField(n), SpectrumField(n)};
    for (const GroupSolution& group : groups) {
      reflected_.add(group.reflected, group.reflected_deviation);
      if (!group.mirrored.empty()) mirrored_.add(group.mirrored, group.mirrored_deviation);
      if (group.has_sky) sky_ = {group.gathered_direct, group.gathered_deviation};
    }
    const PatchLookup lookup(system.scene);
    const std::vector<FilterGrid> grids = filter_grids(system.scene, lookup, Lattices(system.scene, lookup));
    const auto filter = [&](const Component& component, const SpectrumField& lit) {
      return IrradianceFilter(grids, component.irradiance, component.deviation, system.scattering.albedo, lit);
    };
    reflected_filter_.emplace(filter(reflected_, reflected_.irradiance));
    if (!is_black(mirrored_.irradiance)) mirrored_filter_.emplace(filter(mirrored_, reflected_.irradiance));
    if (!sky_.irradiance.empty()) sky_filter_.emplace(filter(sky_, sky_.irradiance));
  }

  /// Filters a group's components, adds them to `energy`, and to `total` with the unfiltered deviations.
  void add_group(const std::string& name, GroupSolution group, EnergyField& energy, SampledSolution& total) const {
    if (group.has_sky) {
      group.gathered_direct = sky_filter_->apply(group.gathered_direct);
      group.gathered_deviation.clear();
    }
    SpectrumField direct = std::move(group.explicit_direct), indirect = reflected_filter_->apply(group.reflected);
    add(group.gathered_direct, direct);
    add(group.sampled_direct, direct);
    if (mirrored_filter_ && !group.mirrored.empty()) add(mirrored_filter_->apply(group.mirrored), indirect);
    add(direct, total.irradiance);
    add(indirect, total.irradiance);
    add(group.gathered_deviation, total.deviation);
    add(group.explicit_deviation, total.deviation);
    add(group.sampled_deviation, total.deviation);
    add(group.residual, total.residual);
    energy.groups.push_back(
        {name, to_colors(direct, name), to_colors(indirect, name), to_colors(group.gathered_direct, name)});
    if (!group.sampled_direct.empty()) energy.groups.back().sampled_direct = to_colors(group.sampled_direct, name);
    energy.groups.back().by_coats = to_colors(group.coats.reflected, name);
    if (mirrored_filter_ && !group.over_metals.empty())
      energy.groups.back().over_metals = to_colors(mirrored_filter_->apply(group.over_metals), name);
  }

  /// The filters with the components' unfiltered deviations, for the error estimate.
  std::vector<SampledSolution::Filtered> filtered() const {
    std::vector<SampledSolution::Filtered> result{{&*reflected_filter_, &reflected_.deviation}};
    if (mirrored_filter_) result.push_back({&*mirrored_filter_, &mirrored_.deviation});
    if (sky_filter_) result.push_back({&*sky_filter_, &sky_.deviation});
    return result;
  }

 private:
  Component reflected_, mirrored_, sky_;
  std::optional<IrradianceFilter> reflected_filter_, mirrored_filter_, sky_filter_;
};

/// Records iterations and residuals in `energy`; warns of groups that did not converge.
void record_convergence(const PatchSet& scene, const std::vector<GroupSolution>& groups, const SolveConfig& config,
                        EnergyField& energy, Progress& progress) {
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const LinearSolve& linear = groups[g].linear;
    energy.iterations += linear.iterations;
    energy.convergence.push_back({scene.light_groups[g], linear.residuals});
    energy.residual = std::max(energy.residual, linear.residual);
    if (linear.residual <= config.tolerance) continue;
    progress.warning(
        fmt::format("light group `{}` stopped after {} iterations at a residual of {:.2g}: raise "
                    "solve.tolerance ({})",
                    scene.light_groups[g], linear.iterations, linear.residual, config.tolerance));
  }
}

}  // namespace

EnergyField solve_matrix(const PatchSet& scene, const SolveConfig& config, int rays, Transport& transport,
                         Progress& progress) {
  EnergyField energy;
  energy.rays = complete_transport(scene, config, rays, transport, progress);
  begin_part(SolvePart::linear_system, config, progress);
  const RadiositySystem system(scene, transport);
  const std::size_t n = system.areas.size();
  std::vector<GroupSolution> groups = solve_groups(system, config.tolerance, progress);
  record_convergence(scene, groups, config, energy, progress);
  SpectrumField external_irradiance(n);
  CoatExchange coats;
  for (const GroupSolution& group : groups) {
    add(group.external_irradiance, external_irradiance);
    if (group.coats.reflected.empty()) continue;
    coats.resize(n);
    add(group.coats.reflected, coats.reflected);
    add(group.coats.unmatched, coats.unmatched);
  }

  const FilteredComponents components(system, groups);
  SampledSolution total{SpectrumField(n), SpectrumField(n), components.filtered(), SpectrumField(n)};
  for (std::size_t g = 0; g < groups.size(); ++g)
    components.add_group(scene.light_groups[g], std::move(groups[g]), energy, total);

  const std::vector<double> areas = visible_areas(scene, transport);
  const EnergyBalance balance(scene, system.rows, areas, system.scattering, std::move(external_irradiance),
                              total.irradiance, coats);
  energy.estimate = estimate_error(scene, system.rows, system.scattering, system.areas, total, balance);
  energy.estimate->reciprocity = reciprocity_error(transport, system.rows, receiving_areas(scene, areas));
  energy.estimate->balance = balance.error();
  return energy;
}

}  // namespace patchlight

#include "solver/methods/matrix_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "pipeline/model/error.h"
#include "pipeline/optics/lights/direct_light.h"
#include "solver/error/consistency.h"
#include "solver/error/error_estimate.h"
#include "solver/linear/irradiance_filter.h"
#include "solver/linear/linear_system.h"
#include "solver/transport/transport_builder.h"

namespace patchlight {

namespace {

using Exchange = FormFactorRows::Field;

constexpr int kMostIterations = 500;

/// What every group's solve reads.
struct System {
  const PatchSet& scene;
  const Transport& transport;
  const FormFactorRows rows;
  const std::vector<Emitter> emitters;  ///< Those of `transport`.
  std::vector<double> areas;
  SpectrumField reflectance;

  System(const PatchSet& patches, const Transport& from)
      : scene(patches), transport(from), rows(from, patches.sky_cells()), emitters(explicit_emitters(patches)) {
    for (const Patch& patch : scene.patches) {
      areas.push_back(patch.covered_area());
      reflectance.emplace_back(patch.reflectance);
    }
  }
};

/// Irradiance of one light group, and how far half the samples are from it.
struct GroupSolution {
  SpectrumField separate;    ///< Straight from emitters that are sampled apart.
  SpectrumField gathered;    ///< Straight from others; empty: none.
  SpectrumField by_mirrors;  ///< From emitters by way of mirrors; empty: none.
  SpectrumField by_photons;  ///< The part of it that photons brought, of emitters sampled apart; empty: none.
  SpectrumField reflected;   ///< From what patches reflect.
  SpectrumField explicit_deviation, gathered_deviation, by_mirrors_deviation, reflected_deviation;  ///< As those are.
  SpectrumField from_outside;  ///< What no patch sends: of lights and the environment; empty: none.
  bool sky = false;            ///< Whether it holds the light of the environment, by the rows.
  LinearSolve linear;

  void expect_mirrors(std::size_t patches) {
    by_mirrors.resize(patches);
    by_mirrors_deviation.resize(patches);
  }

  /// `factors`: of both halves of each patch.
  template <class Factor>
  void add_from_outside(const Spectrum& strength, const std::vector<Factor>& factors) {
    from_outside.resize(factors.size() / 2);
    for (std::size_t i = 0; i < from_outside.size(); ++i)
      from_outside[i] += strength * (Spectrum(factors[2 * i]) + Spectrum(factors[2 * i + 1])) * Spectrum(0.5);
  }
};

/// Emission of a group: of emitters that are sampled apart, one by one, and of all else that rows end on.
struct Emission {
  std::vector<Spectrum> separate;
  SpectrumField others;  ///< [n], and behind that the environment's cells if it is of the group.
};

Emission emission_of(const System& system, std::int32_t group) {
  const std::size_t n = system.areas.size();
  Emission emission{{}, SpectrumField(n)};
  for (std::size_t i = 0; i < n; ++i)
    if (const Patch& patch = system.scene.patches[i]; system.scene.primitives[patch.primitive].light_group == group)
      emission.others[i] = Spectrum(patch.emission);
  for (const Emitter& emitter : system.emitters) {
    if (emitter.light >= 0) {
      const Light& light = system.scene.lights[emitter.light];
      emission.separate.push_back(light.light_group == group ? Spectrum(light.strength) : Spectrum());
      continue;
    }
    emission.separate.push_back(emission.others[emitter.first_patch]);
    std::fill_n(emission.others.begin() + emitter.first_patch, emitter.patches, Spectrum());
  }
  if (const auto& sky = system.scene.environment; sky && sky->light_group == group)
    for (const Color& cell : sky->cells) emission.others.push_back(Spectrum(cell) * Spectrum(kPi));
  return emission;
}

void add(const SpectrumField& field, SpectrumField& sum) {
  for (std::size_t i = 0; i < field.size(); ++i) sum[i] += field[i];
}

bool is_black(const SpectrumField& field) {
  return std::all_of(field.begin(), field.end(), [](const Spectrum& s) { return s.sum() == 0; });
}

void add_emitters(const System& system, const Emission& emission, GroupSolution& solution) {
  const std::size_t n = system.areas.size();
  for (std::size_t k = 0; k < system.emitters.size(); ++k) {
    const Transport::Emitter& emitter = system.transport.emitters[k];
    const Spectrum exitance = emission.separate[k];
    if (exitance.sum() == 0) continue;
    for (std::size_t i = 0; i < n; ++i) {
      const double a = emitter.factors[2 * i], b = emitter.factors[2 * i + 1];
      solution.separate[i] += exitance * Spectrum(0.5 * (a + b));
      solution.explicit_deviation[i] += exitance * Spectrum(0.5 * (a - b));
    }
    if (system.emitters[k].light >= 0) solution.add_from_outside(exitance, emitter.factors);
  }
}

/// Light of emitters that comes by the rows, straight and by way of mirrors.
void add_rows(const System& system, const Emission& emission, GroupSolution& solution) {
  const std::size_t n = system.areas.size();
  if (is_black(emission.others)) return;
  solution.gathered.resize(n);
  solution.gathered_deviation.resize(n);
  const Exchange field{&emission.others, {&solution.gathered, &solution.gathered_deviation}};
  system.rows.gather({&field, 1}, nullptr, FormFactorRows::Precision::full);
  if (!system.transport.mirrored.empty()) {
    solution.expect_mirrors(n);
    system.rows.gather_mirrored(emission.others, solution.by_mirrors, solution.by_mirrors_deviation);
    for (std::size_t i = 0; i < n; ++i) {
      solution.gathered[i] -= solution.by_mirrors[i];
      solution.gathered_deviation[i] -= solution.by_mirrors_deviation[i];
    }
  }
  if (emission.others.size() == n) return;
  solution.sky = true;
  SpectrumField sky = emission.others, received(n);
  std::fill_n(sky.begin(), n, Spectrum());
  system.rows.gather(sky, received);
  solution.from_outside.resize(n);
  for (std::size_t i = 0; i < n; ++i) solution.from_outside[i] += received[i];
}

/// Light of emitters sampled apart that comes by way of mirrors.
void add_photons(const System& system, const Emission& emission, GroupSolution& solution) {
  const std::size_t n = system.areas.size();
  for (std::size_t k = 0; k < system.emitters.size(); ++k) {
    const Transport::Emitter& emitter = system.transport.emitters[k];
    const Spectrum exitance = emission.separate[k];
    if (emitter.mirrored.empty() || exitance.sum() == 0) continue;
    solution.by_photons.resize(n);
    solution.expect_mirrors(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Spectrum a(emitter.mirrored[2 * i]), b(emitter.mirrored[2 * i + 1]);
      const Spectrum received = exitance * (a + b) * Spectrum(0.5);
      solution.by_photons[i] += received;
      solution.by_mirrors[i] += received;
      solution.by_mirrors_deviation[i] += exitance * (a - b) * Spectrum(0.5);
    }
    if (system.emitters[k].light >= 0) solution.add_from_outside(exitance, emitter.mirrored);
  }
}

/// What comes straight from a group's emitters and by way of mirrors.
GroupSolution emitted_light(const System& system, std::int32_t group) {
  const Emission emission = emission_of(system, group);
  GroupSolution solution;
  for (auto* field :
       {&solution.separate, &solution.explicit_deviation, &solution.reflected, &solution.reflected_deviation})
    field->resize(system.areas.size());
  add_emitters(system, emission, solution);
  add_rows(system, emission, solution);
  add_photons(system, emission, solution);
  return solution;
}

/// Solves for light groups side by side.
void add_reflected_light(const System& system, std::span<GroupSolution> groups, double tolerance, Progress& progress) {
  const std::size_t n = system.areas.size();
  const auto precision = FormFactorRows::precision_for(tolerance);
  std::vector<SpectrumField> sent, sources(groups.size(), SpectrumField(n)), indirect(sources);
  for (const GroupSolution& group : groups) add(group.gathered, sent.emplace_back(group.separate));
  std::vector<Exchange> fields;
  for (std::size_t g = 0; g < groups.size(); ++g) fields.push_back({&sent[g], {&sources[g]}});
  system.rows.gather(fields, &system.reflectance, precision);
  for (std::size_t g = 0; g < groups.size(); ++g) add(groups[g].by_mirrors, sources[g]);

  std::vector<LinearSolve> solves =
      solve_irradiance(system.rows, system.reflectance, system.areas, sources, tolerance, kMostIterations, indirect,
                       [&](double residual) {
                         progress.update(std::min(0.99, std::log(residual) / std::log(tolerance)),
                                         fmt::format("residual {:.2g}", residual));
                       });

  // One more pass, whose halves tell their deviation.
  for (std::size_t g = 0; g < groups.size(); ++g) {
    add(indirect[g], sent[g]);
    fields[g] = {&sent[g], {&groups[g].reflected, &groups[g].reflected_deviation}};
    groups[g].linear = std::move(solves[g]);
  }
  system.rows.gather(fields, &system.reflectance, precision);
}

void warn_of_residual(const std::string& group, const LinearSolve& linear, const SolveConfig& config,
                      Progress& progress) {
  progress.warning(
      fmt::format("light group `{}` stopped after {} iterations at a residual of {:.2g}: raise "
                  "solve.tolerance ({})",
                  group, linear.iterations, linear.residual, config.tolerance));
}

}  // namespace

EnergyField solve_matrix(const PatchSet& scene, const SolveConfig& config, int rays, Transport& transport,
                         Progress& progress) {
  EnergyField energy;
  energy.rays = complete_transport(scene, config, rays, transport, progress);
  const System system(scene, transport);
  const std::size_t n = system.areas.size();
  std::vector<GroupSolution> groups;
  for (std::size_t g = 0; g < scene.light_groups.size(); ++g) groups.push_back(emitted_light(system, std::int32_t(g)));
  for (std::size_t g = 0; g < groups.size(); g += RadiosityTable::kMaxFields)
    add_reflected_light(system,
                        std::span(groups).subspan(g).first(std::min(groups.size() - g, RadiosityTable::kMaxFields)),
                        config.tolerance, progress);
  SpectrumField reflected(n), reflected_deviation(n), from_outside(n);
  SpectrumField by_mirrors, by_mirrors_deviation, by_sky, by_sky_deviation;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const GroupSolution& group = groups[g];
    energy.iterations += group.linear.iterations;
    energy.convergence.push_back({scene.light_groups[g], group.linear.residuals});
    energy.residual = std::max(energy.residual, group.linear.residual);
    if (group.linear.residual > config.tolerance)
      warn_of_residual(scene.light_groups[g], group.linear, config, progress);
    add(group.reflected, reflected);
    add(group.reflected_deviation, reflected_deviation);
    add(group.from_outside, from_outside);
    if (!group.by_mirrors.empty()) {
      by_mirrors.resize(n);
      by_mirrors_deviation.resize(n);
      add(group.by_mirrors, by_mirrors);
      add(group.by_mirrors_deviation, by_mirrors_deviation);
    }
    if (!group.sky) continue;
    by_sky = group.gathered;
    by_sky_deviation = group.gathered_deviation;
  }

  const PatchLookup lookup(scene);
  const IrradianceFilter filter(lookup, scene.primitives.size(), reflected, reflected_deviation, system.reflectance,
                                reflected);
  std::optional<IrradianceFilter> mirror_filter, sky_filter;
  SampledSolution all{SpectrumField(n), SpectrumField(n), {{&filter, reflected_deviation}}, energy.residual};
  if (!is_black(by_mirrors)) {
    mirror_filter.emplace(lookup, scene.primitives.size(), by_mirrors, by_mirrors_deviation, system.reflectance,
                          reflected);
    all.filtered.push_back({&*mirror_filter, by_mirrors_deviation});
  }
  if (!by_sky.empty()) {
    sky_filter.emplace(lookup, scene.primitives.size(), by_sky, by_sky_deviation, system.reflectance, by_sky);
    all.filtered.push_back({&*sky_filter, by_sky_deviation});
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    GroupSolution solution = std::move(groups[g]);
    if (solution.sky) {
      solution.gathered = sky_filter->apply(solution.gathered);
      solution.gathered_deviation.clear();
    }
    SpectrumField direct = std::move(solution.separate), indirect = filter.apply(solution.reflected);
    add(solution.gathered, direct);
    if (mirror_filter && !solution.by_mirrors.empty()) add(mirror_filter->apply(solution.by_mirrors), indirect);
    add(direct, all.irradiance);
    add(indirect, all.irradiance);
    add(solution.gathered_deviation, all.deviation);
    add(solution.explicit_deviation, all.deviation);
    const std::string& name = scene.light_groups[g];
    energy.groups.push_back(
        {name, to_colors(direct, name), to_colors(indirect, name), to_colors(solution.gathered, name)});
    if (mirror_filter && !solution.by_photons.empty())
      energy.groups.back().by_photons = to_colors(mirror_filter->apply(solution.by_photons), name);
  }
  energy.estimate = estimate_error(scene, system.rows, system.reflectance, system.areas, all);
  const std::vector<double> visible_fractions = visible_areas(scene, transport);
  energy.estimate->reciprocity = reciprocity_error(transport, system.rows, visible_fractions);
  SpectrumField emission;
  for (const Patch& patch : scene.patches) emission.emplace_back(patch.emission);
  energy.estimate->balance =
      balance_error(system.rows, visible_fractions, system.reflectance, emission, from_outside, all.irradiance);
  return energy;
}

}  // namespace patchlight

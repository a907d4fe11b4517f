#include "solver/methods/group_solution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "solver/form_factors/coated_rows.h"
#include "solver/form_factors/row_scattering.h"

namespace patchlight {

namespace {

using Field = FormFactorRows::Field;

constexpr int kMaxIterations = 500;

/// Emission of a light group, W/m2.
struct Emission {
  std::vector<Spectrum> explicit_exitances;  ///< [emitters] Of the explicitly sampled emitters.
  SpectrumField sampled;                     ///< [n] Of emitters that a LightTree chose; empty: none in the group.
  SpectrumField gathered;                    ///< [n] Of other patches, then of the environment's cells if in the group.
};

Emission emission_of(const RadiositySystem& system, std::int32_t group) {
  const std::size_t n = system.areas.size();
  Emission emission{{}, {}, SpectrumField(n)};
  for (std::size_t i = 0; i < n; ++i)
    if (const Patch& patch = system.scene.patches[i]; system.scene.primitives[patch.primitive].light_group == group)
      emission.gathered[i] = Spectrum(patch.emission);
  for (const Emitter& emitter : system.emitters) {
    if (emitter.light >= 0) {
      const Light& light = system.scene.lights[emitter.light];
      emission.explicit_exitances.push_back(light.light_group == group ? Spectrum(light.strength) : Spectrum());
      continue;
    }
    emission.explicit_exitances.push_back(emission.gathered[emitter.first_patch]);
    std::fill_n(emission.gathered.begin() + emitter.first_patch, emitter.patches, Spectrum());
  }
  for (const Emitter& emitter : system.further) {
    if (system.scene.primitives[emitter.primitive].light_group != group) continue;
    emission.sampled.resize(n);
    for (std::int32_t i = emitter.first_patch; i < emitter.first_patch + emitter.patches; ++i)
      std::swap(emission.sampled[i], emission.gathered[i]);
  }
  if (const auto& sky = system.scene.environment; sky && sky->light_group == group)
    for (const Color& cell : sky->cells) emission.gathered.push_back(Spectrum(cell) * Spectrum(kPi));
  return emission;
}

/// Adds the direct light of explicitly sampled emitters.
void add_explicit_light(const RadiositySystem& system, const Emission& emission, GroupSolution& solution) {
  const std::size_t n = system.areas.size();
  for (std::size_t k = 0; k < system.emitters.size(); ++k) {
    const Transport::Emitter& emitter = system.transport.emitters[k];
    const Spectrum exitance = emission.explicit_exitances[k];
    if (exitance.sum() == 0) continue;
    for (std::size_t i = 0; i < n; ++i) {
      const Spectrum a(emitter.received(2 * i)), b(emitter.received(2 * i + 1));
      solution.explicit_direct[i] += exitance * (a + b) * Spectrum(0.5);
      solution.explicit_deviation[i] += exitance * (a - b) * Spectrum(0.5);
    }
    if (system.emitters[k].light >= 0)
      solution.add_external(exitance, n, [&](std::size_t at) { return emitter.received(at); });
  }
}

/// Adds light of emitters that a LightTree chose, direct and by specular reflection.
void add_sampled_light(const RadiositySystem& system, const Emission& emission, GroupSolution& solution) {
  const std::size_t n = system.areas.size();
  if (emission.sampled.empty()) return;
  solution.sampled_direct.resize(n);
  solution.sampled_deviation.resize(n);
  gather_lights(system.transport.lights, emission.sampled, solution.sampled_direct, &solution.sampled_deviation);
  if (system.transport.mirrored.empty() || !has_metals(system.scene)) return;
  solution.resize_mirrored(n);
  system.rows.gather_mirrored(emission.sampled, solution.mirrored, solution.mirrored_deviation);
}

/// Adds light of emitters that is gathered with the form factors, direct and by specular reflection.
void add_gathered_light(const RadiositySystem& system, const Emission& emission, GroupSolution& solution) {
  const std::size_t n = system.areas.size();
  if (is_black(emission.gathered)) return;
  solution.gathered_direct.resize(n);
  solution.gathered_deviation.resize(n);
  const Field field{&emission.gathered, {&solution.gathered_direct, &solution.gathered_deviation}};
  system.rows.gather({&field, 1}, nullptr, FormFactorRows::Precision::full);
  if (!system.transport.mirrored.empty()) {
    SpectrumField mirrored(n), deviation(n);
    system.rows.gather_mirrored(emission.gathered, mirrored, deviation);
    for (std::size_t i = 0; i < n; ++i) {
      solution.gathered_direct[i] -= mirrored[i];
      solution.gathered_deviation[i] -= deviation[i];
    }
    solution.resize_mirrored(n);
    add(mirrored, solution.mirrored);
    add(deviation, solution.mirrored_deviation);
  }
  if (emission.gathered.size() == n) return;
  solution.has_sky = true;
  SpectrumField sky = emission.gathered, sky_irradiance(n);
  std::fill_n(sky.begin(), n, Spectrum());
  system.rows.gather(sky, sky_irradiance);
  solution.external_irradiance.resize(n);
  for (std::size_t i = 0; i < n; ++i) solution.external_irradiance[i] += sky_irradiance[i];
}

/// Adds specularly reflected light of explicitly sampled emitters.
void add_light_over_metals(const RadiositySystem& system, const Emission& emission, GroupSolution& solution) {
  const std::size_t n = system.areas.size();
  for (std::size_t k = 0; k < system.emitters.size(); ++k) {
    const Transport::Emitter& emitter = system.transport.emitters[k];
    const Spectrum exitance = emission.explicit_exitances[k];
    if (emitter.mirrored.empty() || exitance.sum() == 0) continue;
    solution.over_metals.resize(n);
    solution.resize_mirrored(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Spectrum a(emitter.mirrored[2 * i]), b(emitter.mirrored[2 * i + 1]);
      const Spectrum received = exitance * (a + b) * Spectrum(0.5);
      solution.over_metals[i] += received;
      solution.mirrored[i] += received;
      solution.mirrored_deviation[i] += exitance * (a - b) * Spectrum(0.5);
    }
    if (system.emitters[k].light >= 0)
      solution.add_external(exitance, n, [&](std::size_t at) { return emitter.mirrored[at]; });
  }
}

/// Adds the light of sampled emitters that coats reflect.
void add_light_of_coats(const RadiositySystem& system, const Emission& emission, GroupSolution& solution) {
  const std::size_t n = system.areas.size();
  if (!system.coat_light.any() || system.transport.rays == 0) return;
  solution.coats.resize(n);
  const auto add = [&](std::size_t i, const Spectrum& irradiance, const Spectrum& factor, bool by_surface) {
    solution.coats.reflected[i] += irradiance * factor;
    const Patch& patch = system.scene.patches[i];
    if (by_surface && passes_by_chance(system.scene, system.scene.primitives[patch.primitive]))
      solution.coats.unmatched[i] += irradiance * system.coat_light.mean_factor(i);
  };
  for (std::size_t k = 0; k < system.emitters.size(); ++k) {
    const Spectrum exitance = emission.explicit_exitances[k];
    if (exitance.sum() == 0) continue;
    const Transport::Emitter& emitter = system.transport.emitters[k];
    for (std::size_t i = 0; i < n; ++i) {
      const Spectrum factor =
          (Spectrum(emitter.received(2 * i)) + Spectrum(emitter.received(2 * i + 1))) * Spectrum(0.5);
      if (factor.sum() != 0)
        add(i, exitance * factor, system.coat_light.factor(system.emitters[k], i), system.emitters[k].light < 0);
    }
  }
  if (has_metals(system.scene)) return;
  for (std::size_t i = 0; i < solution.sampled_direct.size(); ++i)
    add(i, solution.sampled_direct[i], system.coat_light.further_factor(i), true);
}

/// Direct and specularly reflected light of a group's emitters.
GroupSolution emitted_light(const RadiositySystem& system, std::int32_t group) {
  const Emission emission = emission_of(system, group);
  GroupSolution solution;
  for (auto* field :
       {&solution.explicit_direct, &solution.explicit_deviation, &solution.reflected, &solution.reflected_deviation})
    field->resize(system.areas.size());
  add_explicit_light(system, emission, solution);
  add_sampled_light(system, emission, solution);
  add_gathered_light(system, emission, solution);
  add_light_over_metals(system, emission, solution);
  add_light_of_coats(system, emission, solution);
  return solution;
}

/// Solves for the reflected light of up to RadiosityTable::kMaxFields light groups at once.
void add_reflected_light(const RadiositySystem& system, std::span<GroupSolution> groups, double tolerance,
                         Progress& progress) {
  const std::size_t n = system.areas.size();
  const auto precision = FormFactorRows::precision_for(tolerance);
  std::vector<SpectrumField> irradiance, sources(groups.size(), SpectrumField(n)), indirect(sources);
  for (const GroupSolution& group : groups) {
    add(group.gathered_direct, irradiance.emplace_back(group.explicit_direct));
    add(group.sampled_direct, irradiance.back());
  }
  std::vector<Field> fields;
  for (std::size_t g = 0; g < groups.size(); ++g) fields.push_back({&irradiance[g], {&sources[g]}});
  system.rows.gather(fields, &system.scattering, precision);
  std::vector<SpectrumField> by_coats(groups.size()), coat_deviations(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (!groups[g].coats.reflected.empty()) {
      by_coats[g].resize(n);
      coat_deviations[g].resize(n);
      const Field field{&groups[g].coats.reflected, {&by_coats[g], &coat_deviations[g]}};
      system.rows.gather({&field, 1}, nullptr, precision);
    }
    add(by_coats[g], sources[g]);
    add(groups[g].mirrored, sources[g]);
  }

  std::vector<LinearSolve> solves = solve_irradiance(
      system.rows, system.scattering, system.areas, sources, tolerance, kMaxIterations, indirect, [&](double residual) {
        progress.update(std::min(0.99, std::log(residual) / std::log(tolerance)),
                        fmt::format("residual {:.2g}", residual));
      });

  // Another gathering pass finds the deviation from its sample sets.
  for (std::size_t g = 0; g < groups.size(); ++g) {
    add(indirect[g], irradiance[g]);
    fields[g] = {&irradiance[g], {&groups[g].reflected, &groups[g].reflected_deviation}};
    groups[g].linear = std::move(solves[g]);
  }
  system.rows.gather(fields, &system.scattering, precision);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    add(by_coats[g], groups[g].reflected);
    add(coat_deviations[g], groups[g].reflected_deviation);
    groups[g].residual = std::move(indirect[g]);
    for (std::size_t i = 0; i < n; ++i) groups[g].residual[i] = groups[g].reflected[i] - groups[g].residual[i];
    add(groups[g].mirrored, groups[g].residual);
  }
}

}  // namespace

RadiositySystem::RadiositySystem(const PatchSet& patches, const Transport& from)
    : scene(patches),
      transport(from),
      rows(from, patches.sky_cells()),
      emitters(explicit_emitters(patches)),
      further(further_emitters(patches)),
      scattering(row_scattering(patches, from.rays > 0)),
      coat_light(patches, from.lights) {
  for (const Patch& patch : scene.patches) areas.push_back(patch.covered_area());
}

std::vector<GroupSolution> solve_groups(const RadiositySystem& system, double tolerance, Progress& progress) {
  std::vector<GroupSolution> groups;
  for (std::size_t g = 0; g < system.scene.light_groups.size(); ++g)
    groups.push_back(emitted_light(system, std::int32_t(g)));
  for (std::size_t g = 0; g < groups.size(); g += RadiosityTable::kMaxFields)
    add_reflected_light(system,
                        std::span(groups).subspan(g).first(std::min(groups.size() - g, RadiosityTable::kMaxFields)),
                        tolerance, progress);
  return groups;
}

}  // namespace patchlight

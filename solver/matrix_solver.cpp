#include "solver/matrix_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/model/error.h"
#include "solver/consistency.h"
#include "solver/error_estimate.h"
#include "solver/linear_system.h"
#include "solver/transport_builder.h"

namespace patchlight {

namespace {

constexpr int kMostIterations = 500;

/// What every group's solve reads.
struct System {
  const PatchSet& scene;
  const Transport& transport;
  const FormFactorRows rows;
  std::vector<double> areas;
  SpectrumField reflectance;

  System(const PatchSet& patches, const Transport& from) : scene(patches), transport(from), rows(from) {
    for (const Patch& patch : scene.patches) {
      areas.push_back(patch.area);
      reflectance.emplace_back(patch.reflectance);
    }
  }
};

/// Irradiance of one light group, and how far half the samples are from it.
struct GroupSolution {
  SpectrumField direct, by_rows, indirect;
  SpectrumField direct_deviation, deviation;
  LinearSolve linear;
};

/// Emission of a group: of emitters that are sampled apart, and of the others. Shape: [n + 1].
struct Emission {
  SpectrumField apart, others;
};

Emission emission_of(const System& system, std::int32_t group) {
  const std::size_t n = system.areas.size();
  Emission emission{SpectrumField(n + 1), SpectrumField(n + 1)};
  for (std::size_t i = 0; i < n; ++i)
    if (const Patch& patch = system.scene.patches[i]; system.scene.primitives[patch.primitive].light_group == group)
      emission.others[i] = Spectrum(patch.emission);
  for (const auto& emitter : system.transport.emitters)
    for (std::int32_t j = emitter.first_patch; j < emitter.first_patch + emitter.patches; ++j)
      std::swap(emission.apart[j], emission.others[j]);
  return emission;
}

bool is_black(const SpectrumField& field) {
  return std::all_of(field.begin(), field.end(), [](const Spectrum& s) { return s.sum() == 0; });
}

void add_emitters(const System& system, const Emission& emission, GroupSolution& solution) {
  const std::size_t n = system.areas.size();
  for (const auto& emitter : system.transport.emitters) {
    const Spectrum exitance = emission.apart[emitter.first_patch];
    if (exitance.sum() == 0) continue;
    for (std::size_t i = 0; i < n; ++i) {
      const double a = emitter.factors[2 * i], b = emitter.factors[2 * i + 1];
      solution.direct[i] += exitance * Spectrum(0.5 * (a + b));
      solution.direct_deviation[i] += exitance * Spectrum(0.5 * (a - b));
    }
  }
}

GroupSolution solve_group(const System& system, std::int32_t group, double tolerance, Progress& progress) {
  const std::size_t n = system.areas.size();
  const Emission emission = emission_of(system, group);
  GroupSolution solution;
  for (auto* field : {&solution.direct, &solution.indirect, &solution.direct_deviation, &solution.deviation})
    field->resize(n);
  SpectrumField by_mirrors(n), apart_by_mirrors(n);
  add_emitters(system, emission, solution);
  if (!is_black(emission.others)) {
    SpectrumField& by_rows = solution.by_rows;
    by_rows.resize(n);
    system.rows.receive(emission.others, by_rows);
    system.rows.receive_mirrored(emission.others, by_mirrors);
    for (std::size_t i = 0; i < n; ++i) {
      by_rows[i] -= by_mirrors[i];
      solution.direct[i] += by_rows[i];
    }
  }
  if (!system.transport.mirrored.empty()) system.rows.receive_mirrored(emission.apart, apart_by_mirrors);

  SpectrumField reflected(n + 1), source(n);
  for (std::size_t i = 0; i < n; ++i) reflected[i] = system.reflectance[i] * solution.direct[i];
  system.rows.receive(reflected, source);
  for (std::size_t i = 0; i < n; ++i) source[i] += by_mirrors[i] + apart_by_mirrors[i];
  solution.linear = solve_irradiance(system.rows, system.reflectance, system.areas, source, tolerance, kMostIterations,
                                     solution.indirect, [&](double residual) {
                                       progress.update(std::min(0.99, std::log(residual) / std::log(tolerance)),
                                                       fmt::format("residual {:.2g}", residual));
                                     });

  // One more pass, whose halves tell their deviation.
  for (std::size_t i = 0; i < n; ++i)
    reflected[i] = system.reflectance[i] * (solution.direct[i] + solution.indirect[i]) + emission.others[i];
  system.rows.receive(reflected, solution.indirect, solution.deviation);
  for (std::size_t i = 0; i < n; ++i) {
    solution.indirect[i] += apart_by_mirrors[i];
    if (!solution.by_rows.empty()) solution.indirect[i] -= solution.by_rows[i];
  }
  return solution;
}

Color to_color(const Spectrum& s) {
  return Color(float(std::max(s.c[0], 0.0)), float(std::max(s.c[1], 0.0)), float(std::max(s.c[2], 0.0)));
}

std::vector<Color> to_colors(const SpectrumField& field, const std::string& group) {
  std::vector<Color> colors;
  colors.reserve(field.size());
  for (const Spectrum& s : field) {
    colors.push_back(to_color(s));
    const Color& c = colors.back();
    if (!std::isfinite(c.x + c.y + c.z))
      throw Error(ExitCode::bad_data, "light group `" + group + "` is too strong for single precision", "energy.h5",
                  "give its emitters less, and frames more by `lights` or the exposure");
  }
  return colors;
}

}  // namespace

EnergyField solve_matrix(const PatchSet& scene, const SolveConfig& config, Transport& transport, Progress& progress) {
  EnergyField energy;
  energy.rays = complete_transport(scene, config, transport, progress);
  const System system(scene, transport);
  const std::size_t n = system.areas.size();
  SampledSolution all{SpectrumField(n), SpectrumField(n), SpectrumField(n)};
  for (std::size_t g = 0; g < scene.light_groups.size(); ++g) {
    const GroupSolution solution = solve_group(system, std::int32_t(g), config.tolerance, progress);
    auto& group = energy.groups.emplace_back();
    group.name = scene.light_groups[g];
    group.direct = to_colors(solution.direct, group.name);
    group.indirect = to_colors(solution.indirect, group.name);
    group.direct_by_rows = to_colors(solution.by_rows, group.name);
    energy.iterations += solution.linear.iterations;
    energy.residual = std::max(energy.residual, solution.linear.residual);
    for (std::size_t i = 0; i < n; ++i) {
      all.irradiance[i] += solution.direct[i] + solution.indirect[i];
      all.deviation[i] += solution.deviation[i];
      all.direct_deviation[i] += solution.direct_deviation[i];
    }
    if (solution.linear.residual > config.tolerance)
      progress.warning(
          fmt::format("light group `{}` stopped after {} iterations at a residual of {:.2g}: raise "
                      "solve.tolerance ({})",
                      group.name, solution.linear.iterations, solution.linear.residual, config.tolerance));
  }
  all.residual = energy.residual;
  energy.estimate = estimate_error(scene, system.rows, system.reflectance, system.areas, all);
  energy.estimate->reciprocity = reciprocity_error(transport, system.rows, system.areas);
  SpectrumField emission;
  for (const Patch& patch : scene.patches) emission.emplace_back(patch.emission);
  energy.estimate->balance = balance_error(system.rows, system.areas, system.reflectance, emission, all.irradiance);
  return energy;
}

}  // namespace patchlight

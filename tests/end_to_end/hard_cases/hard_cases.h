#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <string>

#include "solver/solve.h"
#include "tests/patch_scene.h"

namespace patchlight::test {

struct Configuration {
  const char* method;
  const char* form_factors;
};
inline constexpr std::array<Configuration, 4> kConfigurations{
    {{"matrix", "rays"}, {"matrix", "hemicube"}, {"progressive", "rays"}, {"progressive", "hemicube"}}};

/// Largest permitted errors, in the order of kConfigurations.
using Limits = std::array<double, 4>;

/// Settings of every configuration. Scenes are small, so hemicube cells and rays cause the errors, not patches.
inline SolveConfig hard_case_config() {
  SolveConfig config;
  config.display = false;
  config.rays = 1024;
  config.hemicube_resolution = 128;
  config.tolerance = 1e-4;
  config.max_shots = 100;
  return config;
}

inline EnergyField solve_quietly(const PatchSet& scene, const Configuration& configuration,
                                 SolveConfig config = hard_case_config()) {
  config.method = configuration.method;
  config.form_factors = configuration.form_factors;
  Progress progress({"test", true, ""});
  return solve(scene, config, progress);
}

inline double irradiance_at(const EnergyField& energy, std::size_t patch) {
  double sum = 0;
  for (const auto& group : energy.groups) sum += double(group.direct[patch].y) + double(group.indirect[patch].y);
  return sum;
}

/// Exact irradiance of a patch; NaN: the patch does not count.
using ExactIrradiance = std::function<double(const Patch&)>;
inline const double kNotCounted = std::nan("");

/// Area-weighted relative RMS error of irradiance.
inline double irradiance_error(const PatchSet& scene, const EnergyField& energy, const ExactIrradiance& irradiance) {
  double square = 0, norm = 0;
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    const Patch& patch = scene.patches[i];
    const double exact = irradiance(patch);
    if (std::isnan(exact)) continue;
    square += patch.area * std::pow(irradiance_at(energy, i) - exact, 2);
    norm += patch.area * exact * exact;
  }
  return std::sqrt(square / norm);
}

/// Prints a table with one row for each case: `slow_test --gtest_filter='HardCases.*' | grep '^|'`.
class HardCases : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::cout << "| case | matrix, rays | matrix, hemicube | progressive, rays | progressive, hemicube |\n"
              << "| --- | --- | --- | --- | --- |\n";
  }

  static void print_row(const std::string& name, const std::array<std::string, 4>& cells) {
    std::cout << fmt::format("| {} | {} |\n", name, fmt::join(cells, " | "));
  }

  static std::string percent(double error) {
    if (error == 0) return "0";
    return error < 1e-5 ? "<0.001%" : fmt::format("{:.2g}%", 100 * error);
  }

  /// Calls error(configuration) for each configuration, prints the returned errors and checks them against `limits`.
  template <class Error>
  void expect_each(const std::string& name, const Limits& limits, Error error) {
    std::array<std::string, 4> cells;
    for (std::size_t k = 0; k < kConfigurations.size(); ++k) {
      stopped_at_ = 0;
      const double measured = error(kConfigurations[k]);
      EXPECT_LE(measured, limits[k]) << name << " by " << kConfigurations[k].method << " over "
                                     << kConfigurations[k].form_factors;
      cells[k] = percent(measured);
      if (stopped_at_ > 0) cells[k] += fmt::format(", unshot {:.2g}", stopped_at_);
    }
    print_row(name, cells);
  }

  /// Checks a scene whose exact irradiance is known.
  void expect_exact(const std::string& name, const PatchSet& scene, const ExactIrradiance& exact, const Limits& limits,
                    const SolveConfig& config = hard_case_config()) {
    expect_each(name, limits, [&](const Configuration& configuration) {
      return irradiance_error(scene, solved(scene, configuration, config), exact);
    });
  }

  /// Checks that the irradiance of a scene is that of `usual`, solved by the same configuration, times `factor`; a
  /// factor of NaN leaves the patch out.
  void expect_same(const std::string& name, const PatchSet& scene, const PatchSet& usual, const ExactIrradiance& factor,
                   const Limits& limits, const SolveConfig& config = hard_case_config()) {
    expect_each(name, limits, [&](const Configuration& configuration) {
      const EnergyField before = solve_quietly(usual, configuration, config);
      return irradiance_error(scene, solved(scene, configuration, config), [&](const Patch& patch) {
        const double times = factor(patch);
        return std::isnan(times) ? times : times * irradiance_at(before, std::size_t(&patch - scene.patches.data()));
      });
    });
  }

  /// Solves a scene, and expects a warning if the solve stops above its tolerance.
  EnergyField solved(const PatchSet& scene, const Configuration& configuration,
                     const SolveConfig& config = hard_case_config()) {
    testing::internal::CaptureStderr();
    const EnergyField energy = solve_quietly(scene, configuration, config);
    warnings_ = testing::internal::GetCapturedStderr();
    if (energy.residual > config.tolerance) {
      stopped_at_ = energy.residual;
      EXPECT_NE(warnings_.find("stopped after"), std::string::npos) << warnings_;
    }
    return energy;
  }

  std::string warnings_;  ///< Of the last solve.

 private:
  double stopped_at_ = 0;  ///< Residual of a solve that stopped above its tolerance.
};

}  // namespace patchlight::test

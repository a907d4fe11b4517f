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

/// What each pair's error has to stay below, in the order of kConfigurations.
using Limits = std::array<double, 4>;

/// Every pair's settings but for its names: small scenes, so that cells and rays, not patches, are what errors are of.
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

/// A patch's irradiance as it should be; NaN: this patch does not count.
using Known = std::function<double(const Patch&)>;
inline const double kNotCounted = std::nan("");

/// Area-weighted relative RMS of irradiance about what is known.
inline double irradiance_error(const PatchSet& scene, const EnergyField& energy, const Known& known) {
  double square = 0, norm = 0;
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    const Patch& patch = scene.patches[i];
    const double exact = known(patch);
    if (std::isnan(exact)) continue;
    square += patch.area * std::pow(irradiance_at(energy, i) - exact, 2);
    norm += patch.area * exact * exact;
  }
  return std::sqrt(square / norm);
}

/// One row of the table for each case; `slow_test --gtest_filter='HardCases.*' | grep '^|'` prints it.
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

  /// Calls error(pair) for each pair, and prints and checks what it returns.
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

  /// The same for a scene whose irradiance is known.
  void expect_known(const std::string& name, const PatchSet& scene, const Known& known, const Limits& limits,
                    const SolveConfig& config = hard_case_config()) {
    expect_each(name, limits, [&](const Configuration& configuration) {
      return irradiance_error(scene, solved(scene, configuration, config), known);
    });
  }

  /// The same for a scene that the same pair has to solve as `usual`, times `factor`, but for patches that it makes
  /// NaN.
  void expect_same(const std::string& name, const PatchSet& scene, const PatchSet& usual, const Known& factor,
                   const Limits& limits, const SolveConfig& config = hard_case_config()) {
    expect_each(name, limits, [&](const Configuration& configuration) {
      const EnergyField before = solve_quietly(usual, configuration, config);
      return irradiance_error(scene, solved(scene, configuration, config), [&](const Patch& patch) {
        const double times = factor(patch);
        return std::isnan(times) ? times : times * irradiance_at(before, std::size_t(&patch - scene.patches.data()));
      });
    });
  }

  /// A solve that stops before its tolerance has to say so.
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
  double stopped_at_ = 0;  ///< The residual of a solve that did not get to its tolerance.
};

}  // namespace patchlight::test

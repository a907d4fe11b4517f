#include "solver/linear/linear_system.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace patchlight {
namespace {

constexpr int kPatches = 40;

/// Rows with random columns: a fraction `probability` of 16 for each sample set.
Transport random_rows(double probability, bool weighted) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> patch(0, kPatches - 1);
  std::uniform_real_distribution<float> unit(0, 1);
  Transport rows;
  rows.starts.push_back(0);
  rows.rays = weighted ? 0 : 32;
  if (!weighted) rows.hit_weights.assign(2 * kPatches, 1.0f / 16);
  for (int sample_set = 0; sample_set < 2 * kPatches; ++sample_set) {
    for (int k = 0; k < 16; ++k) {
      if (unit(random) >= probability) continue;
      rows.columns.push_back(patch(random));
      if (weighted) rows.weights.push_back(unit(random) / 16);
    }
    rows.starts.push_back(rows.columns.size());
  }
  return rows;
}

SpectrumField random_field(float low, float high) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> value(low, high);
  SpectrumField field;
  for (int i = 0; i < kPatches; ++i) field.emplace_back(Color(value(random), value(random), value(random)));
  return field;
}

/// Largest difference of x from source + F rho x, over the largest source.
double residual(const FormFactorRows& rows, const SpectrumField& reflectance, const SpectrumField& source,
                const SpectrumField& x) {
  SpectrumField reflected(kPatches), received(kPatches);
  for (int i = 0; i < kPatches; ++i) reflected[i] = reflectance[i] * x[i];
  rows.gather(reflected, received);
  double worst = 0, largest = 0;
  for (int i = 0; i < kPatches; ++i)
    for (int k = 0; k < 3; ++k) {
      worst = std::max(worst, std::abs(source[i].c[k] + received[i].c[k] - x[i].c[k]));
      largest = std::max(largest, std::abs(source[i].c[k]));
    }
  return worst / largest;
}

LinearSolve solve(const FormFactorRows& rows, const SpectrumField& reflectance, const SpectrumField& source,
                  SpectrumField& x, double tolerance = 1e-10, int max_iterations = 1000) {
  const std::vector<double> areas(kPatches, 0.5);
  std::vector<SpectrumField> fields{x};
  const auto solves =
      solve_irradiance(rows, {reflectance}, areas, {source}, tolerance, max_iterations, fields, [](double) {});
  x = fields[0];
  return solves[0];
}

TEST(LinearSystem, IsSolvedForAnyRows) {
  for (const bool weighted : {false, true}) {
    const Transport transport = random_rows(0.8, weighted);
    const FormFactorRows rows(transport);
    const SpectrumField reflectance = random_field(0.1f, 0.9f), source = random_field(0.0f, 5.0f);
    SpectrumField x(kPatches);
    EXPECT_LE(solve(rows, reflectance, source, x).residual, 1e-10);
    EXPECT_LT(residual(rows, reflectance, source, x), 1e-8);
  }
}

TEST(LinearSystem, ResultIsTheBestOfAllIterations) {
  const Transport transport = random_rows(1.0, false);
  const FormFactorRows rows(transport);
  const SpectrumField reflectance(kPatches, Spectrum(0.99999)), source = random_field(-5.0f, 5.0f);
  for (int iterations = 1; iterations < 60; ++iterations) {
    SpectrumField x(kPatches);
    const LinearSolve result = solve(rows, reflectance, source, x, 0, iterations);
    EXPECT_EQ(result.residual, *std::min_element(result.residuals.begin(), result.residuals.end())) << iterations;
  }
}

TEST(LinearSystem, IsSolvedAtReflectancesNearOne) {
  const Transport transport = random_rows(1.0, false);
  const FormFactorRows rows(transport);
  const SpectrumField reflectance(kPatches, Spectrum(0.9999)), source(kPatches, Spectrum(1.0));
  SpectrumField x(kPatches);
  solve(rows, reflectance, source, x, 1e-9);
  for (const Spectrum& value : x) EXPECT_NEAR(value.c[1], 1e4, 1);
}

TEST(LinearSystem, SolvesChannelsOfAnyMagnitude) {
  const Transport transport = random_rows(0.9, false);
  const FormFactorRows rows(transport);
  const SpectrumField reflectance = random_field(0.5f, 0.9f);
  SpectrumField source = random_field(0.5f, 1.0f), x(kPatches);
  for (Spectrum& s : source) s *= Spectrum(Color(1e9f, 1e-9f, 0.0f));
  EXPECT_LE(solve(rows, reflectance, source, x).residual, 1e-10);
  for (const Spectrum& value : x) {
    EXPECT_GT(value.c[0], 1e8);
    EXPECT_GT(value.c[1], 1e-10);
    EXPECT_EQ(value.c[2], 0);
  }
}

TEST(LinearSystem, SourcesTogetherAreSolvedAsAlone) {
  const Transport transport = random_rows(0.9, false);
  const FormFactorRows rows(transport);
  const SpectrumField reflectance = random_field(0.1f, 0.9f);
  const std::vector<double> areas(kPatches, 0.5);
  for (const double tolerance : {1e-4, 1e-9}) {
    std::vector<SpectrumField> sources, together;
    for (int k = 0; k < int(RadiosityTable::kMaxFields); ++k) {
      SpectrumField& source = sources.emplace_back(random_field(0.0f, 2.0f));
      for (int i = 0; i < 7 * k; ++i) source[i] = Spectrum();  // for different numbers of iterations
      together.emplace_back(kPatches);
    }
    const auto solves = solve_irradiance(rows, {reflectance}, areas, sources, tolerance, 100, together, [](double) {});
    for (std::size_t k = 0; k < sources.size(); ++k) {
      SpectrumField alone(kPatches);
      const LinearSolve solve_alone = solve(rows, reflectance, sources[k], alone, tolerance, 100);
      EXPECT_EQ(solves[k].residuals, solve_alone.residuals);
      for (int i = 0; i < kPatches; ++i)
        for (int c = 0; c < 3; ++c) EXPECT_EQ(together[k][i].c[c], alone[i].c[c]);
    }
  }
}

TEST(LinearSystem, WithoutASourceIsZero) {
  const Transport transport = random_rows(0.9, false);
  SpectrumField x(kPatches);
  const LinearSolve result = solve(FormFactorRows(transport), random_field(0.1f, 0.9f), SpectrumField(kPatches), x);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(result.residual, 0);
}

TEST(LinearSystem, StopsAtTheIterationLimitAndReportsTheResidual) {
  const Transport transport = random_rows(1.0, false);
  SpectrumField x(kPatches);
  const LinearSolve result =
      solve(FormFactorRows(transport), SpectrumField(kPatches, Spectrum(0.99)), random_field(0.0f, 1.0f), x, 1e-12, 1);
  EXPECT_EQ(result.iterations, 1);
  EXPECT_GT(result.residual, 1e-12);
}

TEST(FormFactorRows, InSinglePrecisionDifferByRoundingOnly) {
  for (const bool weighted : {false, true}) {
    const Transport transport = random_rows(0.8, weighted);
    const FormFactorRows rows(transport);
    const SpectrumField light = random_field(0.0f, 3.0f), uniform(kPatches, Spectrum(0.1f));
    SpectrumField full(kPatches), single(kPatches), of_uniform(kPatches);
    rows.gather(light, full);
    const std::vector<FormFactorRows::Field> fields{{&light, {&single}}, {&uniform, {&of_uniform}}};
    rows.gather(fields, nullptr, FormFactorRows::Precision::single);
    const SpectrumField row_sums = rows.row_sums();
    for (int i = 0; i < kPatches; ++i) {
      EXPECT_NEAR(single[i].c[1], full[i].c[1], 1e-6);
      EXPECT_NEAR(of_uniform[i].c[1], double(0.1f) * row_sums[i].c[1], 1e-15);  // equal values sum exactly
    }
  }
}

TEST(FormFactorRows, ReportTheDeviationOfTheirSampleSets) {
  Transport transport;
  transport.starts = {0, 2, 3};
  transport.columns = {0, 1, 0};
  transport.hit_weights = {0.5f, 1.0f};
  transport.rays = 4;
  transport.mirrored = {{0, 1, 0, Color(0.5f, 0.25f, 0.0f)}};
  const FormFactorRows rows(transport);
  SpectrumField light(2), received(1), deviation(1);
  light[0] = Spectrum(4.0);
  const FormFactorRows::Field field{&light, {&received, &deviation}};
  rows.gather({&field, 1}, nullptr,
              FormFactorRows::Precision::full);  // sample sets: 2, and 4 + 4 times the mirror's weight
  EXPECT_DOUBLE_EQ(received[0].c[0], 0.5 * (2 + 6));
  EXPECT_DOUBLE_EQ(received[0].c[1], 0.5 * (2 + 5));
  EXPECT_DOUBLE_EQ(deviation[0].c[0], 0.5 * (2 - 6));
  rows.gather_mirrored(light, received, deviation);
  EXPECT_DOUBLE_EQ(received[0].c[0], 1);
  EXPECT_DOUBLE_EQ(deviation[0].c[0], -1);
}

}  // namespace
}  // namespace patchlight

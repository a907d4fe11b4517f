#include "solver/linear/irradiance_filter.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/system/vector_code.h"
#include "solver/linear/filter_error.h"

namespace patchlight {

namespace {

constexpr std::array<int, 6> kWidths{1, 5, 7, 9, 13, 19};  // window widths in patches

/// Weights of a window's values in the least-squares parabola at each of its positions. Shape: [m][m].
std::vector<double> fit_projection(int m) {
  std::vector<std::vector<double>> basis;
  for (int degree = 0; degree < std::min(m, 3); ++degree) {
    std::vector<double> q(m);
    for (int k = 0; k < m; ++k) q[k] = std::pow(2.0 * k / std::max(m - 1, 1) - 1, degree);
    for (const auto& earlier : basis) {
      double dot = 0;
      for (int k = 0; k < m; ++k) dot += q[k] * earlier[k];
      for (int k = 0; k < m; ++k) q[k] -= dot * earlier[k];
    }
    double norm = 0;
    for (const double x : q) norm += x * x;
    for (double& x : q) x /= std::sqrt(norm);
    basis.push_back(q);
  }
  std::vector<double> weights(m * m, 0.0);
  for (const auto& q : basis)
    for (int i = 0; i < m; ++i)
      for (int k = 0; k < m; ++k) weights[i * m + k] += q[i] * q[k];
  return weights;
}

/// The cached weights for a window of m values.
const std::vector<double>& projection(int m) {
  static const auto projections = [] {
    std::array<std::vector<double>, kWidths.back() + 1> all;
    for (int k = 1; k <= kWidths.back(); ++k) all[k] = fit_projection(k);
    return all;
  }();
  return projections[m];
}

/// Smooths a line of `cells` values with a stride of `step`.
VECTOR_CODE void smooth_line(const Spectrum* from, Spectrum* to, int cells, int step, int width) {
  const int m = std::min(width, cells);
  const std::vector<double>& weights = projection(m);
  for (int i = 0; i < cells; ++i) {
    const int start = std::clamp(i - m / 2, 0, cells - m);
    Spectrum sum;
    for (int k = 0; k < m; ++k) sum += from[(start + k) * step] * Spectrum(weights[(i - start) * m + k]);
    to[i * step] = sum;
  }
}

/// Smooths along one axis of a grid: `lines` lines of `cells` values with a stride of `step`, each between its closed
/// edges: `ends` tells the values after which one is, or is empty.
void smooth_lines(const SpectrumField& from, SpectrumField& to, int lines, int line_step, int cells, int step,
                  int width, const std::vector<bool>& ends) {
  for (int line = 0; line < lines; ++line)
    for (int first = 0, last = 0; first < cells; first = last) {
      const int start = line * line_step;
      do ++last;
      while (last < cells && (ends.empty() || !ends[start + (last - 1) * step]));
      smooth_line(from.data() + start + first * step, to.data() + start + first * step, last - first, step, width);
    }
}

/// Sums over the square of `radius` patches to either side, without the central patch.
std::vector<double> neighbourhood_sums(const std::vector<double>& values, int nu, int nv, int radius) {
  const auto along = [radius](const std::vector<double>& from, int lines, int line_step, int cells, int step) {
    std::vector<double> to(from.size());
    for (int line = 0; line < lines; ++line)
      for (int i = 0; i < cells; ++i)
        for (int k = std::max(0, i - radius); k <= std::min(cells - 1, i + radius); ++k)
          to[line * line_step + i * step] += from[line * line_step + k * step];
    return to;
  };
  std::vector<double> sums = along(along(values, nv, nu, nu, 1), nu, 1, nv, nu);
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] -= values[i];
  return sums;
}

SpectrumField smoothed(const SpectrumField& values, const FilterGrid& grid, int width) {
  SpectrumField along(values.size()), both(values.size());
  smooth_lines(values, along, grid.nv, grid.nu, grid.nu, 1, width, grid.ends_along_u);
  smooth_lines(along, both, grid.nu, 1, grid.nv, grid.nu, width, grid.ends_along_v);
  return both;
}

/// A field at a grid's cells.
SpectrumField values_of(const FilterGrid& grid, const SpectrumField& field) {
  if (grid.patches.empty()) return {field.begin() + grid.first, field.begin() + grid.first + grid.cells()};
  SpectrumField values(grid.patches.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (grid.patches[i] >= 0) values[i] = field[grid.patches[i]];
  return values;
}

}  // namespace

IrradianceFilter::IrradianceFilter(const std::vector<FilterGrid>& grids, const SpectrumField& irradiance,
                                   const SpectrumField& deviation, const SpectrumField& reflectance,
                                   const SpectrumField& lit)
    : choice_(irradiance.size(), 0), bias_(irradiance.size()) {
  std::copy_if(grids.begin(), grids.end(), std::back_inserter(grids_), [&](const FilterGrid& grid) {
    for (std::int32_t i = 0; i < grid.cells(); ++i)
      if (grid.patch(i) >= 0 && irradiance[grid.patch(i)].sum() != 0) return true;
    return false;
  });
  tbb::parallel_for(std::size_t(0), grids_.size(),
                    [&](std::size_t g) { choose(grids_[g], irradiance, deviation, reflectance, lit); });
}

void IrradianceFilter::choose(const FilterGrid& grid, const SpectrumField& irradiance, const SpectrumField& deviation,
                              const SpectrumField& reflectance, const SpectrumField& lit) {
  const SpectrumField mean = values_of(grid, irradiance), half_difference = values_of(grid, deviation),
                      weight = values_of(grid, reflectance);
  const std::size_t cells = mean.size();
  SpectrumField narrow = mean, narrow_noise = half_difference;
  std::vector<double> increase(cells);  // of the squared error by the wider window
  for (std::uint8_t width = 1; width < kWidths.size(); ++width) {
    if (kWidths[width - 1] >= std::max(grid.nu, grid.nv)) break;
    SpectrumField wide = smoothed(mean, grid, kWidths[width]);
    SpectrumField wide_noise = smoothed(half_difference, grid, kWidths[width]);
    for (std::size_t i = 0; i < cells; ++i)
      increase[i] = error_increase({narrow[i], narrow_noise[i]}, {wide[i], wide_noise[i]}, weight[i]);
    const std::vector<double> pooled = neighbourhood_sums(increase, grid.nu, grid.nv, kWidths[width]);
    for (std::size_t i = 0; i < cells; ++i) {
      const std::int32_t patch = grid.patch(std::int32_t(i));
      if (patch < 0) continue;
      std::uint8_t& choice = choice_[patch];
      if (choice + 1 != width || pooled[i] >= 0) continue;
      choice = width;
      const double unfiltered = weighted_square(half_difference[i], weight[i]);
      bias_[patch] = {weighted_square(wide[i] - mean[i], weight[i]) -
                          weighted_square(wide_noise[i] - half_difference[i], weight[i]),
                      4.0 / 3 * unfiltered * unfiltered};
    }
    narrow = std::move(wide);
    narrow_noise = std::move(wide_noise);
  }
  for (std::int32_t i = 0; i < grid.cells(); ++i)
    if (const std::int32_t patch = grid.patch(i); patch >= 0 && lit[patch].sum() == 0)
      choice_[patch] = 0, bias_[patch] = {};
}

SpectrumField IrradianceFilter::apply(const SpectrumField& field) const {
  SpectrumField result = field;
  tbb::parallel_for(std::size_t(0), grids_.size(), [&](std::size_t g) {
    const FilterGrid& grid = grids_[g];
    const SpectrumField values = values_of(grid, field);
    std::vector<std::uint8_t> choices;
    for (std::int32_t i = 0; i < grid.cells(); ++i)
      choices.push_back(grid.patch(i) >= 0 ? choice_[grid.patch(i)] : std::uint8_t(0));
    for (std::uint8_t width = 1; width < kWidths.size(); ++width) {
      if (std::find(choices.begin(), choices.end(), width) == choices.end()) continue;
      const SpectrumField smooth = smoothed(values, grid, kWidths[width]);
      for (std::int32_t i = 0; i < grid.cells(); ++i)
        if (choices[i] == width) result[grid.patch(i)] = smooth[i];
    }
  });
  return result;
}

double IrradianceFilter::correlated_patches(std::size_t i) const {
  // The sum of the squared autocorrelation of the weights is nearly 0.345 times the width along each axis.
  const double width = kWidths[choice_[i]];
  return choice_[i] == 0 ? 1.0 : 0.345 * 0.345 * width * width;
}

}  // namespace patchlight

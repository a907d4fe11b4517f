#include "solver/linear_system.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "pipeline/model/error.h"
#include "pipeline/optics/vector_code.h"

namespace patchlight {

namespace {

constexpr std::size_t kBlock = 1024;  // rows that are summed one after the other, whatever the number of threads

/// Calls act(i) for every i below `count`.
template <class Act>
void for_each(std::size_t count, Act act) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (count + kBlock - 1) / kBlock), [&](const auto& range) {
    for (std::size_t i = range.begin() * kBlock; i < std::min(range.end() * kBlock, count); ++i) act(i);
  });
}

/// Sum of term(i), in an order that does not depend on the number of threads.
template <class Term>
Spectrum sum_of(std::size_t count, Term term) {
  std::vector<Spectrum> parts((count + kBlock - 1) / kBlock);
  tbb::parallel_for(std::size_t(0), parts.size(), [&](std::size_t block) {
    for (std::size_t i = block * kBlock; i < std::min((block + 1) * kBlock, count); ++i) parts[block] += term(i);
  });
  Spectrum sum;
  for (const Spectrum& part : parts) sum += part;
  return sum;
}

Spectrum ratio(const Spectrum& a, const Spectrum& b) {
  Spectrum result;
  for (int k = 0; k < 3; ++k) result.c[k] = b.c[k] != 0 && std::isfinite(a.c[k] / b.c[k]) ? a.c[k] / b.c[k] : 0.0;
  return result;
}

/// Largest root of a channel's ratio of squared norms.
double worst(const Spectrum& square, const Spectrum& reference) {
  double largest = 0;
  for (int k = 0; k < 3; ++k)
    if (reference.c[k] > 0) largest = std::max(largest, std::sqrt(square.c[k] / reference.c[k]));
  return largest;
}

VECTOR_CODE void add_all(std::span<const std::int32_t> places, const Spectrum* values, Spectrum& sum) {
  Spectrum even = sum, odd;
  std::size_t k = 0;
  for (; k + 2 <= places.size(); k += 2) {
    even += values[places[k]];
    odd += values[places[k + 1]];
  }
  if (k < places.size()) even += values[places[k]];
  sum = even + odd;
}

}  // namespace

std::vector<Color> to_colors(const SpectrumField& field, const std::string& group) {
  std::vector<Color> colors;
  colors.reserve(field.size());
  for (const Spectrum& s : field) {
    Color c;
    for (int k = 0; k < 3; ++k) c[k] = float(std::max(s.c[k], 0.0));
    if (!std::isfinite(c.x + c.y + c.z))
      throw Error(ExitCode::bad_data, "light group `" + group + "` is too strong for single precision", "energy.h5",
                  "give its emitters less, and frames more by `lights` or the exposure");
    colors.push_back(c);
  }
  return colors;
}

FormFactorRows::FormFactorRows(const TransportRows& rows) : transport_(rows) {
  if (rows.mirrored.empty()) return;
  mirrored_starts_.assign(rows.starts.size(), 0);
  for (const auto& m : rows.mirrored) ++mirrored_starts_[2 * m.row + m.half + 1];
  for (std::size_t k = 1; k < mirrored_starts_.size(); ++k) mirrored_starts_[k] += mirrored_starts_[k - 1];
}

Spectrum FormFactorRows::half(std::int64_t k, const SpectrumField& radiosity) const {
  const std::uint64_t begin = transport_.starts[k], end = transport_.starts[k + 1];
  Spectrum sum;
  if (transport_.rays > 0) {
    add_all(std::span(transport_.ends).subspan(begin, end - begin), radiosity.data(), sum);
    sum *= Spectrum(double(transport_.shares[k]));
  } else {
    for (std::uint64_t at = begin; at < end; ++at)
      sum += radiosity[transport_.ends[at]] * Spectrum(double(transport_.weights[at]));
  }
  if (!mirrored_starts_.empty())
    for (std::uint64_t at = mirrored_starts_[k]; at < mirrored_starts_[k + 1]; ++at)
      sum += radiosity[transport_.mirrored[at].patch] * Spectrum(transport_.mirrored[at].weight);
  return sum;
}

void FormFactorRows::receive(const SpectrumField& radiosity, SpectrumField& irradiance) const {
  for_each(std::size_t(transport_.rows()), [&](std::size_t i) {
    irradiance[i] = (half(std::int64_t(2 * i), radiosity) + half(std::int64_t(2 * i + 1), radiosity)) * Spectrum(0.5);
  });
}

void FormFactorRows::receive(const SpectrumField& radiosity, SpectrumField& irradiance,
                             SpectrumField& deviation) const {
  for_each(std::size_t(transport_.rows()), [&](std::size_t i) {
    const Spectrum a = half(std::int64_t(2 * i), radiosity), b = half(std::int64_t(2 * i + 1), radiosity);
    irradiance[i] = (a + b) * Spectrum(0.5);
    deviation[i] = (a - b) * Spectrum(0.5);
  });
}

void FormFactorRows::receive_mirrored(const SpectrumField& radiosity, SpectrumField& irradiance,
                                      SpectrumField& deviation) const {
  std::fill(irradiance.begin(), irradiance.end(), Spectrum());
  std::fill(deviation.begin(), deviation.end(), Spectrum());
  for (const auto& m : transport_.mirrored) {
    const Spectrum received = radiosity[m.patch] * Spectrum(m.weight) * Spectrum(0.5);
    irradiance[m.row] += received;
    m.half == 0 ? deviation[m.row] += received : deviation[m.row] -= received;
  }
}

LinearSolve solve_irradiance(const FormFactorRows& rows, const SpectrumField& reflectance,
                             const std::vector<double>& areas, const SpectrumField& source, double tolerance,
                             int max_iterations, SpectrumField& x, const std::function<void(double)>& step) {
  const std::size_t n = areas.size();
  SpectrumField reflected(n);
  const auto dot = [&](const SpectrumField& a, const SpectrumField& b) {
    return sum_of(n, [&](std::size_t i) { return a[i] * b[i] * Spectrum(areas[i]); });
  };
  /// out = x - F (reflectance x)
  const auto apply = [&](const SpectrumField& field, SpectrumField& out) {
    for_each(n, [&](std::size_t i) { reflected[i] = reflectance[i] * field[i]; });
    rows.receive(reflected, out);
    for_each(n, [&](std::size_t i) { out[i] = field[i] - out[i]; });
  };

  const Spectrum source_square = dot(source, source);
  SpectrumField r(n), p(n), v(n), s(n), t(n);
  r = source;
  if (std::any_of(x.begin(), x.end(), [](const Spectrum& value) { return value.sum() != 0; })) {
    apply(x, v);
    for_each(n, [&](std::size_t i) { r[i] -= v[i]; });
  }
  SpectrumField shadow = r;
  Spectrum r_square = dot(r, r), rho = r_square;
  p = r;
  LinearSolve result{0, worst(r_square, source_square)};
  while (result.residual > tolerance && result.iterations < max_iterations) {
    step(result.residual);
    apply(p, v);
    const Spectrum alpha = ratio(rho, dot(shadow, v));
    for_each(n, [&](std::size_t i) { s[i] = r[i] - alpha * v[i]; });
    if (const double halfway = worst(dot(s, s), source_square); halfway <= tolerance) {
      for_each(n, [&](std::size_t i) { x[i] += alpha * p[i]; });
      return {result.iterations + 1, halfway};
    }
    apply(s, t);
    const Spectrum omega = ratio(dot(t, s), dot(t, t));
    for_each(n, [&](std::size_t i) {
      x[i] += alpha * p[i] + omega * s[i];
      r[i] = s[i] - omega * t[i];
    });
    const Spectrum rho_next = dot(shadow, r);
    const Spectrum beta = ratio(rho_next, rho) * ratio(alpha, omega);
    for_each(n, [&](std::size_t i) { p[i] = r[i] + beta * (p[i] - omega * v[i]); });
    rho = rho_next;
    r_square = dot(r, r);
    result.residual = worst(r_square, source_square);
    ++result.iterations;
    // A breakdown, where the shadow residual has become orthogonal to the residual: start again from here.
    for (int k = 0; k < 3; ++k)
      if (std::abs(rho.c[k]) < 1e-12 * std::sqrt(r_square.c[k] * dot(shadow, shadow).c[k])) {
        shadow = p = r;
        rho = r_square;
        break;
      }
  }
  return result;
}

}  // namespace patchlight

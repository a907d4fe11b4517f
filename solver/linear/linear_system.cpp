#include "solver/linear/linear_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pipeline/model/error.h"
#include "solver/linear/parallel_rows.h"

namespace patchlight {

namespace {

Spectrum ratio(const Spectrum& a, const Spectrum& b) {
  Spectrum result;
  for (int k = 0; k < 3; ++k) result.c[k] = b.c[k] != 0 && std::isfinite(a.c[k] / b.c[k]) ? a.c[k] / b.c[k] : 0.0;
  return result;
}

/// Largest ratio of norms of any channel, from their squares.
double largest_ratio(const Spectrum& square, const Spectrum& reference) {
  double largest = 0;
  for (int k = 0; k < 3; ++k)
    if (reference.c[k] > 0) largest = std::max(largest, std::sqrt(square.c[k] / reference.c[k]));
  return largest;
}

constexpr double kDiverged = 1e6;     // of a residual, over the least one
constexpr double kImprovement = 0.5;  // of the least residual, for which a restart is worth while

/// State of one source's iteration. The caller computes the products v = F p and t = F r between the steps. After the
/// first half step, r is the vector s of the paper.
class BiCgStab {
 public:
  SpectrumField p, v, r, t;
  LinearSolve result;

  BiCgStab(const std::vector<double>& areas, const SpectrumField& source, SpectrumField& x)
      : p(areas.size()), v(p), r(source), t(p), areas_(areas), source_(source), x_(x) {
    source_square_ = sums_over_rows<1>(areas.size(),
                                       [&](std::size_t i) { return std::array{weighted(source[i], source[i], i)}; })[0];
  }

  bool has_initial_guess() const { return !is_black(x_); }
  bool is_finished(double tolerance, int max_iterations) const {
    return result.residual <= tolerance || result.iterations >= max_iterations || is_hopeless_;
  }

  /// If rounding makes the iteration diverge, as it may where hardly any light is lost, returns to the best solution so
  /// far: with p = x, the caller computes v = F x and begins again, unless that was tried in vain.
  bool returns_to_best() {
    if (!(result.residual > kDiverged * least_residual_)) return false;
    is_hopeless_ = least_residual_ > kImprovement * least_at_restart_;
    least_at_restart_ = least_residual_;
    p = x_ = best_;
    return !is_hopeless_;
  }

  LinearSolve finish() && {
    if (result.residual > least_residual_) {
      x_ = std::move(best_);
      result.residual = least_residual_;
    }
    return std::move(result);
  }

  /// Prepares the first step. With an initial guess, p = x and v = F x.
  void begin(bool with_guess) {
    if (with_guess) for_each_row(size(), [&](std::size_t i) { r[i] = source_[i] - (x_[i] - v[i]); });
    shadow_ = p = r;
    rho_ = r_square_ = shadow_square_ =
        sums_over_rows<1>(size(), [&](std::size_t i) { return std::array{weighted(r[i], r[i], i)}; })[0];
    record(largest_ratio(r_square_, source_square_));
  }

  /// From v = F p to the intermediate residual; true if that has converged.
  bool first_half(double tolerance) {
    const auto [shadow_v] = sums_over_rows<1>(size(), [&](std::size_t i) {
      v[i] = p[i] - v[i];
      return std::array{weighted(shadow_[i], v[i], i)};
    });
    alpha_ = ratio(rho_, shadow_v);
    const auto [square] = sums_over_rows<1>(size(), [&](std::size_t i) {
      r[i] -= alpha_ * v[i];
      return std::array{weighted(r[i], r[i], i)};
    });
    const double intermediate = largest_ratio(square, source_square_);
    if (intermediate > tolerance) return false;
    for_each_row(size(), [&](std::size_t i) { x_[i] += alpha_ * p[i]; });
    ++result.iterations;
    record(intermediate);
    return true;
  }

  /// From t = F r to the next p.
  void second_half() {
    const auto [t_r, t_square] = sums_over_rows<2>(size(), [&](std::size_t i) {
      t[i] = r[i] - t[i];
      return std::array{weighted(t[i], r[i], i), weighted(t[i], t[i], i)};
    });
    const Spectrum omega = ratio(t_r, t_square);
    const auto [rho_next, r_square] = sums_over_rows<2>(size(), [&](std::size_t i) {
      x_[i] += alpha_ * p[i] + omega * r[i];
      r[i] -= omega * t[i];
      return std::array{weighted(shadow_[i], r[i], i), weighted(r[i], r[i], i)};
    });
    const Spectrum beta = ratio(rho_next, rho_) * ratio(alpha_, omega);
    rho_ = rho_next;
    r_square_ = r_square;
    ++result.iterations;
    record(largest_ratio(r_square_, source_square_));
    if (is_breakdown()) {
      shadow_ = p = r;
      rho_ = shadow_square_ = r_square_;
    } else {
      for_each_row(size(), [&](std::size_t i) { p[i] = r[i] + beta * (p[i] - omega * v[i]); });
    }
  }

 private:
  std::size_t size() const { return areas_.size(); }

  Spectrum weighted(const Spectrum& a, const Spectrum& b, std::size_t i) const { return a * b * Spectrum(areas_[i]); }

  void record(double residual) {
    result.residual = residual;
    result.residuals.push_back(residual);
    if (!(residual < least_residual_)) return;
    least_residual_ = residual;
    best_ = x_;
  }

  /// Whether the shadow residual has become orthogonal to the residual, so that the iteration must restart.
  bool is_breakdown() const {
    for (int k = 0; k < 3; ++k)
      if (std::abs(rho_.c[k]) < 1e-12 * std::sqrt(r_square_.c[k] * shadow_square_.c[k])) return true;
    return false;
  }

  const std::vector<double>& areas_;
  const SpectrumField& source_;
  SpectrumField& x_;
  SpectrumField best_;  ///< The solution with the least residual.
  double least_residual_ = std::numeric_limits<double>::infinity();
  double least_at_restart_ = std::numeric_limits<double>::infinity();
  bool is_hopeless_ = false;
  SpectrumField shadow_;
  Spectrum source_square_, rho_, r_square_, shadow_square_, alpha_;
};

}  // namespace

void throw_overflow(const std::string& group) {
  throw Error(ExitCode::bad_data, "light group `" + group + "` is too strong for single precision", "energy.h5",
              "lower the emission of its emitters and brighten frames by `lights` or the exposure");
}

std::vector<Color> to_colors(const SpectrumField& field, const std::string& group) {
  std::vector<Color> colors;
  colors.reserve(field.size());
  for (const Spectrum& s : field) {
    Color c;
    for (int k = 0; k < 3; ++k) c[k] = float(std::max(s.c[k], 0.0));
    if (!std::isfinite(c.x + c.y + c.z)) throw_overflow(group);
    colors.push_back(c);
  }
  return colors;
}

std::vector<LinearSolve> solve_irradiance(const FormFactorRows& rows, const Scattering& scattering,
                                          const std::vector<double>& areas, const std::vector<SpectrumField>& sources,
                                          double tolerance, int max_iterations, std::vector<SpectrumField>& x,
                                          const std::function<void(double)>& step) {
  const auto precision = FormFactorRows::precision_for(tolerance);
  std::vector<BiCgStab> systems;
  for (std::size_t k = 0; k < sources.size(); ++k) systems.emplace_back(areas, sources[k], x[k]);
  std::vector<BiCgStab*> active;
  // to = F M from for all active systems
  const auto apply = [&](SpectrumField BiCgStab::*from, SpectrumField BiCgStab::*to) {
    std::vector<FormFactorRows::Field> fields;
    for (BiCgStab* system : active) fields.push_back({&(system->*from), {&(system->*to)}});
    rows.gather(fields, &scattering, precision);
  };

  for (std::size_t k = 0; k < systems.size(); ++k)
    if (systems[k].has_initial_guess()) {
      systems[k].p = x[k];
      active.push_back(&systems[k]);
    }
  apply(&BiCgStab::p, &BiCgStab::v);
  for (BiCgStab& system : systems) system.begin(system.has_initial_guess());
  for (;;) {
    active.clear();
    double residual = 0;
    for (BiCgStab& system : systems)
      if (!system.is_finished(tolerance, max_iterations)) {
        active.push_back(&system);
        residual = std::max(residual, system.result.residual);
      }
    if (active.empty()) break;
    step(residual);
    apply(&BiCgStab::p, &BiCgStab::v);
    std::erase_if(active, [&](BiCgStab* system) { return system->first_half(tolerance); });
    apply(&BiCgStab::r, &BiCgStab::t);
    for (BiCgStab* system : active) system->second_half();
    std::erase_if(active, [](BiCgStab* system) { return !system->returns_to_best(); });
    if (active.empty()) continue;
    apply(&BiCgStab::p, &BiCgStab::v);
    for (BiCgStab* system : active) system->begin(true);
  }
  std::vector<LinearSolve> results;
  for (BiCgStab& system : systems) results.push_back(std::move(system).finish());
  return results;
}

}  // namespace patchlight

#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/model/transport.h"

namespace patchlight {

/// One value for each channel, and one that pads it for vector registers.
struct alignas(32) Spectrum {
  double c[4] = {0, 0, 0, 0};

  Spectrum() = default;
  explicit Spectrum(double all) : c{all, all, all, 0} {}
  explicit Spectrum(const Color& color) : c{color.x, color.y, color.z, 0} {}

  Spectrum& operator+=(const Spectrum& o) {
    return each(o, [](double& a, double b) { a += b; });
  }
  Spectrum& operator-=(const Spectrum& o) {
    return each(o, [](double& a, double b) { a -= b; });
  }
  Spectrum& operator*=(const Spectrum& o) {
    return each(o, [](double& a, double b) { a *= b; });
  }
  friend Spectrum operator+(Spectrum a, const Spectrum& b) { return a += b; }
  friend Spectrum operator-(Spectrum a, const Spectrum& b) { return a -= b; }
  friend Spectrum operator*(Spectrum a, const Spectrum& b) { return a *= b; }
  double sum() const { return c[0] + c[1] + c[2]; }

 private:
  template <class Do>
  Spectrum& each(const Spectrum& o, Do act) {
    for (int k = 0; k < 4; ++k) act(c[k], o.c[k]);
    return *this;
  }
};

/// A value for each patch or element.
using SpectrumField = std::vector<Spectrum>;

/// For files: negative values count as 0. Throws: Error (bad_data), naming the light group, if one is too large.
std::vector<Color> to_colors(const SpectrumField& field, const std::string& group);

/// Rows of form factors as a linear operator from radiosity to irradiance, both W/m2.
class FormFactorRows {
 public:
  explicit FormFactorRows(const TransportRows& rows);

  /// What each row receives from `radiosity` [elements], directly and by mirrors. Shape: [n].
  void receive(const SpectrumField& radiosity, SpectrumField& irradiance) const;

  /// The same and how far each half is from the mean: half the difference of the first half and the second.
  void receive(const SpectrumField& radiosity, SpectrumField& irradiance, SpectrumField& deviation) const;

  /// What comes by mirrors alone.
  void receive_mirrored(const SpectrumField& radiosity, SpectrumField& irradiance, SpectrumField& deviation) const;

 private:
  Spectrum half(std::int64_t k, const SpectrumField& radiosity) const;

  const TransportRows& transport_;
  std::vector<std::uint64_t> mirrored_starts_;  ///< [2 n + 1]; empty without mirrors.
};

/// How solving a linear system ended.
struct LinearSolve {
  int iterations = 0;
  double residual = 0.0;  ///< Norm of what is left over that of the source, of the worst channel; 0 without a source.
};

/// Solves x = source + F (reflectance x) for the irradiance x by BiCGSTAB (van der Vorst 1992), all channels side by
/// side, in the inner product weighted by `areas`. Starts from the x given. `step` is called before each iteration.
/// The same for any number of threads.
LinearSolve solve_irradiance(const FormFactorRows& rows, const SpectrumField& reflectance,
                             const std::vector<double>& areas, const SpectrumField& source, double tolerance,
                             int max_iterations, SpectrumField& x, const std::function<void(double)>& step);

}  // namespace patchlight

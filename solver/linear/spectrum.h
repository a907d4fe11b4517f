#pragma once
#include <algorithm>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// One value for each colour channel, padded to a vector register.
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

inline bool is_black(const SpectrumField& field) {
  return std::all_of(field.begin(), field.end(), [](const Spectrum& value) { return value.sum() == 0; });
}

/// Adds `field`, which may be empty, to `sum`.
inline void add(const SpectrumField& field, SpectrumField& sum) {
  for (std::size_t i = 0; i < field.size(); ++i) sum[i] += field[i];
}

}  // namespace patchlight

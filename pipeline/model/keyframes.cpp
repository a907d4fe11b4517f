#include "pipeline/model/keyframes.h"

#include <ImathQuat.h>

#include <algorithm>
#include <ranges>

namespace patchlight {

namespace {

using Components = std::vector<double>;

/// Spherical linear interpolation of quaternions along the shorter arc.
Components interpolate_rotation(const Components& a, const Components& b, double t) {
  const auto unit = [](const Components& v) { return Imath::Quatd(v[3], v[0], v[1], v[2]).normalized(); };
  const Imath::Quatd q = Imath::slerpShortestArc(unit(a), unit(b), t);
  return {q.v.x, q.v.y, q.v.z, q.r};
}

Components interpolate_linear(const Components& a, const Components& b, double t) {
  Components value(a.size());
  for (std::size_t k = 0; k < value.size(); ++k) value[k] = a[k] + (b[k] - a[k]) * t;
  return value;
}

/// Cubic Hermite spline. `out` is the tangent at `a`, `in` the tangent at `b`, `span` the time between them in s.
Components interpolate_spline(const Components& a, const Components& out, const Components& in, const Components& b,
                              double t, double span) {
  const double t2 = t * t, t3 = t2 * t;
  Components value(a.size());
  for (std::size_t k = 0; k < value.size(); ++k)
    value[k] = (2 * t3 - 3 * t2 + 1) * a[k] + span * (t3 - 2 * t2 + t) * out[k] + (3 * t2 - 2 * t3) * b[k] +
               span * (t3 - t2) * in[k];
  return value;
}

}  // namespace

std::vector<double> value_at(const Keyframes& keyframes, double seconds) {
  const auto keys = std::views::iota(std::size_t(0), keyframes.count);
  const auto next = std::size_t(std::ranges::upper_bound(keys, seconds, {}, keyframes.time) - keys.begin());
  if (next == 0) return keyframes.value(0, 1);
  const std::size_t key = next - 1;
  const auto a = keyframes.value(key, 1);
  if (next == keyframes.count || keyframes.interpolation == Motion::Interpolation::step) return a;
  const double span = keyframes.time(next) - keyframes.time(key), t = (seconds - keyframes.time(key)) / span;
  const auto b = keyframes.value(next, 1);
  if (keyframes.interpolation == Motion::Interpolation::cubic_spline)
    return interpolate_spline(a, keyframes.value(key, 2), keyframes.value(next, 0), b, t, span);
  return keyframes.turn ? interpolate_rotation(a, b, t) : interpolate_linear(a, b, t);
}

}  // namespace patchlight

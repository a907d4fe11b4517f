#include "pipeline/model/keyframes.h"

#include <ImathQuat.h>

#include <algorithm>
#include <ranges>

namespace patchlight {

namespace {

using Values = std::vector<double>;

/// Of quaternions, the shorter way.
Values turned(const Values& a, const Values& b, double t) {
  const auto unit = [](const Values& v) { return Imath::Quatd(v[3], v[0], v[1], v[2]).normalized(); };
  const Imath::Quatd q = Imath::slerpShortestArc(unit(a), unit(b), t);
  return {q.v.x, q.v.y, q.v.z, q.r};
}

Values on_line(const Values& a, const Values& b, double t) {
  Values value(a.size());
  for (std::size_t k = 0; k < value.size(); ++k) value[k] = a[k] + (b[k] - a[k]) * t;
  return value;
}

/// `span`: s from one keyframe to the next.
Values on_spline(const Values& a, const Values& out, const Values& in, const Values& b, double t, double span) {
  const double t2 = t * t, t3 = t2 * t;
  Values value(a.size());
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
    return on_spline(a, keyframes.value(key, 2), keyframes.value(next, 0), b, t, span);
  return keyframes.turn ? turned(a, b, t) : on_line(a, b, t);
}

}  // namespace patchlight

#include "pipeline/model/motion.h"

#include <ImathQuat.h>

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

using Value = std::array<double, 4>;  // what a kind has no use for is zero

/// Value, or tangent, `part` of keyframe `key`.
Value part_of(const Motion& motion, std::size_t key, int part = 0) {
  Value value{};
  const auto first = motion.values.begin() + std::ptrdiff_t(key) * motion.stride() + part * motion.width();
  std::copy_n(first, motion.width(), value.begin());
  return value;
}

Value between(const Motion& motion, std::size_t key, double t) {
  const Value a = part_of(motion, key), b = part_of(motion, key + 1);
  if (motion.kind == Motion::Kind::rotation) {
    const auto unit = [](const Value& v) { return Imath::Quatd(v[3], v[0], v[1], v[2]).normalized(); };
    const Imath::Quatd q = Imath::slerpShortestArc(unit(a), unit(b), t);
    return {q.v.x, q.v.y, q.v.z, q.r};
  }
  Value value{};
  for (std::size_t k = 0; k < value.size(); ++k) value[k] = a[k] + (b[k] - a[k]) * t;
  return value;
}

/// glTF 2.0, appendix C.5. `span`: s from one keyframe to the next.
Value on_spline(const Motion& motion, std::size_t key, double t, double span) {
  const Value a = part_of(motion, key, 1), out = part_of(motion, key, 2);
  const Value in = part_of(motion, key + 1, 0), b = part_of(motion, key + 1, 1);
  const double t2 = t * t, t3 = t2 * t;
  Value value{};
  for (std::size_t k = 0; k < value.size(); ++k)
    value[k] = (2 * t3 - 3 * t2 + 1) * a[k] + span * (t3 - 2 * t2 + t) * out[k] + (3 * t2 - 2 * t3) * b[k] +
               span * (t3 - t2) * in[k];
  return value;
}

Value value_at(const Motion& motion, double seconds) {
  const bool spline = motion.interpolation == Motion::Interpolation::cubic_spline;
  const auto& times = motion.times;
  const auto next = std::size_t(std::upper_bound(times.begin(), times.end(), seconds) - times.begin());
  if (next == 0 || next == times.size()) return part_of(motion, next == 0 ? 0 : next - 1, spline ? 1 : 0);
  const std::size_t key = next - 1;
  const double span = times[next] - times[key], t = (seconds - times[key]) / span;
  if (motion.interpolation == Motion::Interpolation::step) return part_of(motion, key);
  return spline ? on_spline(motion, key, t, span) : between(motion, key, t);
}

}  // namespace

Matrix4 matrix_at(const Motion& motion, double seconds) {
  Matrix4 matrix;
  if (motion.kind == Motion::Kind::fixed) {
    std::copy_n(motion.values.begin(), 16, &matrix[0][0]);
    return matrix;
  }
  const Value value = value_at(motion, seconds);
  const Vec3d vector(value[0], value[1], value[2]);
  if (motion.kind == Motion::Kind::rotation) return rotation_matrix(value);
  return motion.kind == Motion::Kind::scale ? matrix.setScale(vector) : matrix.setTranslation(vector);
}

Matrix4 rotation_matrix(const std::array<double, 4>& quaternion) {
  auto [x, y, z, w] = quaternion;
  const double length = std::sqrt(x * x + y * y + z * z + w * w);
  if (!(length > 0.0)) return {};
  x /= length, y /= length, z /= length, w /= length;
  return {1 - 2 * (y * y + z * z),
          2 * (x * y + z * w),
          2 * (x * z - y * w),
          0,
          2 * (x * y - z * w),
          1 - 2 * (x * x + z * z),
          2 * (y * z + x * w),
          0,
          2 * (x * z + y * w),
          2 * (y * z - x * w),
          1 - 2 * (x * x + y * y),
          0,
          0,
          0,
          0,
          1};
}

}  // namespace patchlight

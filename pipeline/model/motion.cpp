#include "pipeline/model/motion.h"

#include <algorithm>
#include <cmath>

#include "pipeline/model/keyframes.h"

namespace patchlight {

Matrix4 matrix_at(const Motion& motion, double seconds) {
  Matrix4 matrix;
  if (motion.kind == Motion::Kind::fixed) {
    std::copy_n(motion.values.begin(), 16, &matrix[0][0]);
    return matrix;
  }
  const bool spline = motion.interpolation == Motion::Interpolation::cubic_spline;
  const auto value_part = [&](std::size_t key, int part) {
    const auto first =
        motion.values.begin() + std::ptrdiff_t(key) * motion.stride() + (spline ? part : 0) * motion.width();
    return std::vector<double>(first, first + motion.width());
  };
  const std::vector<double> value =
      value_at({motion.times.size(), motion.interpolation, motion.kind == Motion::Kind::rotation,
                [&](std::size_t key) { return motion.times[key]; }, value_part},
               seconds);
  const Vec3d vector(value[0], value[1], value[2]);
  if (motion.kind == Motion::Kind::rotation) return rotation_matrix({value[0], value[1], value[2], value[3]});
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

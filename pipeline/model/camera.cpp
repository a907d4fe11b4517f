#include "pipeline/model/camera.h"

#include <cmath>

namespace patchlight {

namespace {

Vec3d axis(const Matrix4& matrix, int row) {
  return {matrix[row][0], matrix[row][1], matrix[row][2]};
}

}  // namespace

std::string lens_fault(const Camera& camera) {
  const auto within = [](double x, double low, double high) { return x >= low && x <= high; };
  if (!within(camera.aspect, kMinAspect, kMaxAspect) || !within(std::abs(camera.shift.x), 0, kMaxShift) ||
      !within(std::abs(camera.shift.y), 0, kMaxShift) || !within(camera.znear, 0, kMaxDepth) ||
      !within(camera.aperture, 0, kMaxAperture) || !within(camera.focus, 0, kMaxDepth))
    return "a value is out of range";
  if (!(camera.zfar > camera.znear)) return "`znear` is not below `zfar`";
  if (camera.has_lens() && camera.focus < kMinDepth) return "an `aperture` without a `focus`";
  return "";
}

std::optional<Matrix4> rigid_frame(const Matrix4& to_world) {
  const Vec3d back = axis(to_world, 2);
  const Vec3d origin = axis(to_world, 3);
  if (!(back.length() > 0.0) || !std::isfinite(back.length()) || !std::isfinite(origin.length())) return std::nullopt;
  const Vec3d z = back.normalized();
  const Vec3d up = axis(to_world, 1);
  const Vec3d orthogonal_up = up - z * up.dot(z);
  if (!(orthogonal_up.length() > 1e-12 * up.length()) || !std::isfinite(up.length())) return std::nullopt;
  const Vec3d y = orthogonal_up.normalized();
  const Vec3d x = y.cross(z);
  return Matrix4(x.x, x.y, x.z, 0.0, y.x, y.y, y.z, 0.0, z.x, z.y, z.z, 0.0, origin.x, origin.y, origin.z, 1.0);
}

std::optional<Matrix4> to_world_at(const Camera& camera, double seconds) {
  Matrix4 to_world;
  for (const Motion& factor : camera.motion) to_world *= matrix_at(factor, seconds);
  return rigid_frame(to_world);
}

}  // namespace patchlight

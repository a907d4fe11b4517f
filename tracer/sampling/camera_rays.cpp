#include "tracer/sampling/camera_rays.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {

CameraRays::CameraRays(const Camera& camera, int width, int height)
    : camera_(camera), to_camera_(camera.to_world.inverse()), width_(width), height_(height) {
  half_height_ = perspective() ? std::tan(camera.vertical / 2) : camera.vertical;
  half_width_ = half_height_ * width / height;
  const auto to_world = [&](const Vec3d& v, bool point) {
    Vec3d result;
    point ? camera_.to_world.multVecMatrix(v, result) : camera_.to_world.multDirMatrix(v, result);
    return result;
  };
  const Vec2d upper_left(half_width_ * (2 * camera.shift.x - 1), half_height_ * (2 * camera.shift.y + 1));
  corner_ = perspective() ? to_world(Vec3d(upper_left.x, upper_left.y, -1), false)
                          : to_world(Vec3d(upper_left.x, upper_left.y, 0), true);
  right_ = to_world(Vec3d(2 * half_width_ / width, 0, 0), false);
  eye_ = camera_.to_world.translation();
  forward_ = to_world(Vec3d(0, 0, -1), false).normalized();
  down_ = to_world(Vec3d(0, -2 * half_height_ / height, 0), false);
  lens_right_ = to_world(Vec3d(camera.aperture / 2, 0, 0), false);
  lens_up_ = to_world(Vec3d(0, camera.aperture / 2, 0), false);
}

void CameraRays::generate(const ImagePoints& points, const RayScene& scene, RayPacket& packet) const {
  packet.start();
  auto& ray = packet.rays.ray;
  const std::array<float*, 3> origins{ray.org_x, ray.org_y, ray.org_z}, directions{ray.dir_x, ray.dir_y, ray.dir_z};
  const auto& [constant, varying] = perspective() ? std::pair(origins, directions) : std::pair(directions, origins);
  const Vec3f value = perspective() ? scene.to_local(eye_) : Vec3f(forward_);
  const Vec3f corner = perspective() ? Vec3f(corner_) : scene.to_local(corner_), right(right_), down(down_);
  for (int k = 0; k < 3; ++k) {
    std::fill_n(constant[k], RayPacket::kSize, value[k]);
    for (int lane = 0; lane < RayPacket::kSize; ++lane)
      varying[k][lane] = corner[k] + right[k] * points.x[lane] + down[k] * points.y[lane];
  }
  if (has_lens()) move_to_lens(points, packet);
  if (!perspective() && !has_lens()) return clip(packet);
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const float x = ray.dir_x[lane], y = ray.dir_y[lane], z = ray.dir_z[lane];
    const float scale = 1.0f / std::sqrt(x * x + y * y + z * z);
    ray.dir_x[lane] = x * scale;
    ray.dir_y[lane] = y * scale;
    ray.dir_z[lane] = z * scale;
  }
  clip(packet);
}

/// Moves the origins of rays, whose directions are not yet unit vectors but of depth 1, to their points of the lens.
void CameraRays::move_to_lens(const ImagePoints& points, RayPacket& packet) const {
  auto& ray = packet.rays.ray;
  const std::array<float*, 3> origins{ray.org_x, ray.org_y, ray.org_z}, directions{ray.dir_x, ray.dir_y, ray.dir_z};
  const Vec3f right(lens_right_), up(lens_up_);
  const auto per_focus = float(1 / camera_.focus);
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const Vec3f offset = right * points.lens[lane].x + up * points.lens[lane].y;
    for (int k = 0; k < 3; ++k) {
      origins[k][lane] += offset[k];
      directions[k][lane] -= offset[k] * per_focus;
    }
  }
}

void CameraRays::clip(RayPacket& packet) const {
  if (camera_.znear <= 0 && std::isinf(camera_.zfar)) return;
  auto& ray = packet.rays.ray;
  const Vec3f forward(forward_);
  const auto near = float(camera_.znear), far = float(camera_.zfar);
  for (int lane = 0; lane < RayPacket::kSize; ++lane) {
    const float cosine = packet.direction(lane) ^ forward;
    ray.tnear[lane] = near / cosine;
    ray.tfar[lane] = far / cosine;
  }
}

void CameraRays::set_end(RayPacket& packet, int lane, const Vec3d& position, const Vec3f& direction) const {
  if (std::isinf(camera_.zfar)) return;
  packet.rays.ray.tfar[lane] = float(std::max(0.0, camera_.zfar - depth(position)) / (Vec3d(direction) ^ forward_));
}

Vec3d CameraRays::to_camera(const Vec3d& world) const {
  Vec3d in_camera;
  to_camera_.multVecMatrix(world, in_camera);
  return in_camera;
}

Imath::V2d CameraRays::to_image(const Vec3d& in_camera) const {
  const double scale = perspective() ? -1 / in_camera.z : 1.0;
  return {(0.5 * (1 + in_camera.x * scale / half_width_) - camera_.shift.x) * width_,
          (0.5 * (1 - in_camera.y * scale / half_height_) + camera_.shift.y) * height_};
}

}  // namespace patchlight

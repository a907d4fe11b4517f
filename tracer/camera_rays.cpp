#include "tracer/camera_rays.h"

#include <cmath>

namespace patchlight {

CameraRays::CameraRays(const Camera& camera, int width, int height)
    : camera_(camera), to_camera_(camera.to_world.inverse()), pixels_across_(width), pixels_down_(height) {
  half_height_ = perspective() ? std::tan(camera.vertical / 2) : camera.vertical;
  half_width_ = half_height_ * width / height;
  const auto to_world = [&](const Vec3d& v, bool point) {
    Vec3d result;
    point ? camera_.to_world.multVecMatrix(v, result) : camera_.to_world.multDirMatrix(v, result);
    return result;
  };
  first_ = perspective() ? to_world(Vec3d(-half_width_, half_height_, -1), false)
                         : to_world(Vec3d(-half_width_, half_height_, 0), true);
  across_ = to_world(Vec3d(2 * half_width_ / width, 0, 0), false);
  eye_ = camera_.to_world.translation();
  forward_ = to_world(Vec3d(0, 0, -1), false).normalized();
  down_ = to_world(Vec3d(0, -2 * half_height_ / height, 0), false);
}

CameraRay CameraRays::operator()(float x, float y) const {
  const Vec3d at = first_ + across_ * double(x) + down_ * double(y);
  if (perspective()) {
    const Vec3f along(at);
    return {eye_, along * (1 / std::sqrt(along.length2()))};
  }
  return {at, Vec3f(forward_)};
}

Vec3d CameraRays::to_camera(const Vec3d& world) const {
  Vec3d in_camera;
  to_camera_.multVecMatrix(world, in_camera);
  return in_camera;
}

Imath::V2d CameraRays::to_image(const Vec3d& in_camera) const {
  const double scale = perspective() ? -1 / in_camera.z : 1.0;
  return {0.5 * (1 + in_camera.x * scale / half_width_) * pixels_across_,
          0.5 * (1 - in_camera.y * scale / half_height_) * pixels_down_};
}

}  // namespace patchlight

#include "tracer/camera_rays.h"

#include <cmath>

namespace patchlight {

CameraRays::CameraRays(const Camera& camera, int width, int height)
    : camera_(camera), pixels_across_(width), pixels_down_(height) {
  const bool perspective = camera.projection == Camera::Projection::perspective;
  half_height_ = perspective ? std::tan(camera.vertical / 2) : camera.vertical;
  half_width_ = half_height_ * width / height;
}

CameraRay CameraRays::operator()(float x, float y) const {
  const double across = (2 * x / pixels_across_ - 1) * half_width_;
  const double up = (1 - 2 * y / pixels_down_) * half_height_;
  Vec3d origin(0.0), direction(0, 0, -1);
  if (camera_.projection == Camera::Projection::perspective)
    direction = Vec3d(across, up, -1);
  else
    origin = Vec3d(across, up, 0);
  Vec3d world_origin, world_direction;
  camera_.to_world.multVecMatrix(origin, world_origin);
  camera_.to_world.multDirMatrix(direction, world_direction);
  return {world_origin, Vec3f(world_direction.normalized())};
}

}  // namespace patchlight

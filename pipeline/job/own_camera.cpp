#include "pipeline/job/own_camera.h"

#include <cmath>

namespace patchlight {

namespace {

constexpr double kDefaultAngle = 40;  // degrees

}  // namespace

std::optional<Camera> own_camera(const std::string& name, const CameraConfig& config, int frame) {
  Camera camera;
  camera.name = name;
  camera.projection = config.height ? Camera::Projection::orthographic : Camera::Projection::perspective;
  camera.vertical = config.height ? *config.height / 2 : config.angle.value_or(kDefaultAngle) * kPi / 180;
  const double turns = config.turntable == 0 ? 0 : (frame - 1) / config.turntable;
  Matrix4 turn;
  turn.setAxisAngle(config.up, 2 * kPi * (turns - std::floor(turns)));
  Vec3d back;
  turn.multDirMatrix(config.look_from - config.look_at, back);
  const Vec3d& up = config.up;
  const Vec3d from = config.look_at + back;
  const std::optional<Matrix4> to_world =
      rigid_frame(Matrix4(1, 0, 0, 0, up.x, up.y, up.z, 0, back.x, back.y, back.z, 0, from.x, from.y, from.z, 1));
  if (!to_world) return std::nullopt;
  camera.to_world = *to_world;
  return camera;
}

}  // namespace patchlight

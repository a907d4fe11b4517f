#include "pipeline/job/own_camera.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

constexpr double kDefaultAngle = 40;  // degrees

}  // namespace

std::optional<Camera> own_camera(const std::string& name, const CameraConfig& config, int frame) {
  Camera camera;
  camera.name = name;
  camera.vertical = kDefaultAngle * kPi / 180;
  const Vec3d look_from = config.look_from.value_or(Vec3d(0.0)), look_at = config.look_at.value_or(Vec3d(0.0));
  const Vec3d up = config.up.value_or(Vec3d(0, 1, 0));
  camera.focus = std::clamp((look_from - look_at).length(), kMinDepth, kMaxDepth);
  set_lens(config, camera);
  const double turns = config.turntable == 0 ? 0 : (frame - 1) / config.turntable;
  Matrix4 turn;
  turn.setAxisAngle(up, 2 * kPi * (turns - std::floor(turns)));
  Vec3d back;
  turn.multDirMatrix(look_from - look_at, back);
  const Vec3d from = look_at + back;
  const std::optional<Matrix4> to_world =
      rigid_frame(Matrix4(1, 0, 0, 0, up.x, up.y, up.z, 0, back.x, back.y, back.z, 0, from.x, from.y, from.z, 1));
  if (!to_world) return std::nullopt;
  camera.to_world = *to_world;
  return camera;
}

void set_lens(const CameraConfig& config, Camera& camera) {
  if (config.angle || config.height) {
    camera.projection = config.height ? Camera::Projection::orthographic : Camera::Projection::perspective;
    camera.vertical = config.height ? *config.height / 2 : *config.angle * kPi / 180;
  }
  camera.shift = config.shift.value_or(camera.shift);
  camera.aspect = config.aspect.value_or(camera.aspect);
  camera.znear = config.znear.value_or(camera.znear);
  camera.zfar = config.zfar.value_or(camera.zfar);
  camera.aperture = config.aperture.value_or(camera.aperture);
  camera.focus = config.focus.value_or(camera.focus);
}

}  // namespace patchlight

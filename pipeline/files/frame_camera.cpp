#include "pipeline/files/frame_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/model/error.h"

namespace patchlight {

namespace {

constexpr double kUsualAngle = 40;  // degrees

}  // namespace

Camera FrameCamera::at(int frame, const Job& job) const {
  if (of_job) return own_camera(name, *of_job, frame).value();
  Camera camera{of_scene->name, of_scene->projection, of_scene->to_world, of_scene->vertical, of_scene->aspect, {}};
  if (!moves()) return camera;
  const std::optional<Matrix4> to_world = to_world_at(*of_scene, frame / job.trace.fps);
  if (!to_world)
    throw Error(ExitCode::bad_data, fmt::format("camera `{}` makes no picture at frame {}", name, frame),
                job.scene.filename().string(), "its transform is flat then: leave the frame out of trace.frames");
  camera.to_world = *to_world;
  return camera;
}

std::vector<FrameCamera> frame_cameras(const Job& job, const PatchSet& scene) {
  std::vector<FrameCamera> cameras;
  auto own = job.cameras;
  for (const Camera& camera : scene.cameras) {
    const auto found = job.cameras.find(camera.name);
    cameras.push_back({camera.name, &camera, found == job.cameras.end() ? nullptr : &found->second});
    own.erase(camera.name);
  }
  for (const auto& [name, unused] : own) cameras.push_back({name, nullptr, &job.cameras.at(name)});
  return cameras;
}

std::optional<Camera> own_camera(const std::string& name, const CameraConfig& config, int frame) {
  Camera camera;
  camera.name = name;
  camera.projection = config.height ? Camera::Projection::orthographic : Camera::Projection::perspective;
  camera.vertical = config.height ? *config.height / 2 : config.angle.value_or(kUsualAngle) * kPi / 180;
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

#include "pipeline/frames/frame_camera.h"

#include <fmt/format.h>

#include <optional>

#include "pipeline/job/own_camera.h"
#include "pipeline/model/error.h"

namespace patchlight {

Camera FrameCamera::at(int frame, const Job& job) const {
  if (of_job) return own_camera(name, *of_job, frame).value();
  Camera camera{of_scene->name, of_scene->projection, of_scene->to_world, of_scene->vertical, of_scene->aspect, {}};
  if (!moves()) return camera;
  const std::optional<Matrix4> to_world = to_world_at(*of_scene, frame / job.trace.fps);
  if (!to_world)
    throw Error(ExitCode::bad_data, fmt::format("camera `{}` has a degenerate transform at frame {}", name, frame),
                job.scene.filename().string(), "leave the frame out of trace.frames, or mend the animation");
  camera.to_world = *to_world;
  return camera;
}

std::vector<FrameCamera> frame_cameras(const Job& job, const PatchSet& scene) {
  std::vector<FrameCamera> cameras;
  auto added = job.cameras;
  for (const Camera& camera : scene.cameras) {
    const auto found = job.cameras.find(camera.name);
    cameras.push_back({camera.name, &camera, found == job.cameras.end() ? nullptr : &found->second});
    added.erase(camera.name);
  }
  for (const auto& [name, unused] : added) cameras.push_back({name, nullptr, &job.cameras.at(name)});
  return cameras;
}

}  // namespace patchlight

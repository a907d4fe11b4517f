#include "pipeline/frames/frame_camera.h"

#include <fmt/format.h>

#include <optional>

#include "pipeline/job/own_camera.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

std::string place_of(const std::string& camera, const Job& job) {
  return fmt::format("{}, cameras.{}", job.file.string(), camera);
}

Camera with_checked_lens(const Camera& camera, const Job& job) {
  if (const std::string fault = lens_fault(camera); !fault.empty())
    throw Error(ExitCode::bad_config, fmt::format("camera `{}`: {}", camera.name, fault), place_of(camera.name, job),
                "change it there; what is not set there is the scene's");
  return camera;
}

}  // namespace

Camera FrameCamera::at(int frame, const Job& job) const {
  if (of_job && of_job->has_pose()) return with_checked_lens(own_camera(name, *of_job, frame).value(), job);
  Camera camera = *of_scene;
  camera.motion.clear();
  if (of_job) {
    set_lens(*of_job, camera);
    camera = with_checked_lens(camera, job);
  }
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
  for (const auto& [name, config] : added)
    if (!config.has_pose())
      throw Error(ExitCode::bad_config,
                  fmt::format("the scene has no camera `{}`, and the job gives it no place", name), place_of(name, job),
                  "correct the name, or give `look_from` and `look_at`");
  for (const auto& [name, unused] : added) cameras.push_back({name, nullptr, &job.cameras.at(name)});
  return cameras;
}

}  // namespace patchlight

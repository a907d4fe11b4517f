#pragma once
#include <string>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// A camera of the scene or of the job.
struct FrameCamera {
  std::string name;
  const Camera* of_scene = nullptr;      ///< Null: not in the scene.
  const CameraConfig* of_job = nullptr;  ///< Null: the scene's camera is used. With both: it may change the lens only.

  bool moves() const { return of_job && of_job->has_pose() ? of_job->turntable != 0 : !of_scene->motion.empty(); }

  /// The camera at a frame. In a scene, frame f is f / fps seconds after the start of the animation, as exported by
  /// Blender; a turntable starts at frame 1. Throws: Error (bad_data) if the transform is degenerate, (bad_config) if
  /// the job makes a lens that cannot be.
  Camera at(int frame, const Job& job) const;
};

/// The scene's cameras, replaced or changed by the job's cameras of the same name, followed by the job's other cameras.
/// Throws: Error (bad_config) for one of the job that changes a camera which the scene does not have.
std::vector<FrameCamera> frame_cameras(const Job& job, const PatchSet& scene);

}  // namespace patchlight

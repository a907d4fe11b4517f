#pragma once
#include <string>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// A camera that frames may be seen by: one of the scene, or one of the job's own.
struct FrameCamera {
  std::string name;
  const Camera* of_scene = nullptr;
  const CameraConfig* of_job = nullptr;  ///< Null: it is the scene's.

  bool moves() const { return of_job ? of_job->turntable != 0 : !of_scene->motion.empty(); }

  /// As it stands at a frame. Of the scene's, frame f shows what is f / fps seconds from the start of the animation, as
  /// Blender writes it; a turntable begins with frame 1.
  /// Throws: Error (bad_data) where its transform makes no picture.
  Camera at(int frame, const Job& job) const;
};

/// The scene's cameras, those of which the job has one by the same name replaced, and then the job's others.
std::vector<FrameCamera> frame_cameras(const Job& job, const PatchSet& scene);

}  // namespace patchlight

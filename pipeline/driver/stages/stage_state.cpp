#include "pipeline/driver/stages/stage_state.h"

#include "pipeline/frames/frame_warnings.h"
#include "pipeline/job/stage_keys.h"
#include "pipeline/job/view_config.h"

namespace patchlight {

StageState frames_state(const Job& job, const PatchSet& scene, const OutputCache* cache, std::vector<bool>* fresh) {
  JointFreshness before, now;
  bool restored = false;
  const std::string view_config = view_config_key(job.trace.picture.ocio);
  const std::vector<Frame> frames = job_frames(job, scene);
  for (const Frame& frame : frames) {
    const std::string name = frame.exr.filename().string();
    Freshness one = frame_freshness(job, scene, frame, view_config);
    before.add(name, one);
    if (!one.fresh() && cache && cache->restore_frame(frame, one.key)) {
      one = frame_freshness(job, scene, frame, view_config);
      restored |= one.fresh();
    }
    now.add(name, one);
    if (fresh) fresh->push_back(one.fresh());
  }
  StageState state{now.all(), before.all(), restored};
  if (state.now.fresh()) state.now.warnings = frame_warnings(job, scene, frames);
  return state;
}

void keep_frames(const Job& job, const PatchSet& scene, const OutputCache& cache) {
  const std::string energy = energy_key(scene.key, job.solve), view_config = view_config_key(job.trace.picture.ocio);
  for (const Frame& frame : job_frames(job, scene))
    cache.keep_frame(frame, frame_key(scene, energy, job, frame.camera, frame.number, view_config));
}

}  // namespace patchlight

#pragma once
#include <vector>

#include "pipeline/driver/cache/freshness.h"
#include "pipeline/driver/cache/output_cache.h"

namespace patchlight {

/// Freshness of a stage's output now, and before it was restored from the cache.
struct StageState {
  Freshness now;
  Freshness before;
  bool restored = false;
};

/// Calls `restore` if `freshness` says that the output is not fresh.
template <class FreshnessOf, class Restore>
StageState stage_state(FreshnessOf freshness, Restore restore) {
  const Freshness before = freshness();
  if (before.fresh() || !restore()) return {before, before, false};
  const Freshness now = freshness();
  return {now, before, now.fresh()};
}

/// The combined state of all frames of a job. Frames that are not fresh are restored from `cache`, unless it is null.
/// `fresh`: receives a value for each frame; may be null.
StageState frames_state(const Job& job, const PatchSet& scene, const OutputCache* cache,
                        std::vector<bool>* fresh = nullptr);

/// Adds all frames of a job to the cache.
void keep_frames(const Job& job, const PatchSet& scene, const OutputCache& cache);

}  // namespace patchlight

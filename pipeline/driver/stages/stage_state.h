#pragma once
#include <vector>

#include "pipeline/driver/cache/freshness.h"
#include "pipeline/driver/cache/output_cache.h"

namespace patchlight {

/// A stage's output as it is, and as it was before what was made earlier with the same settings was put back.
struct StageState {
  Freshness now;
  Freshness before;
  bool restored = false;
};

/// Where `freshness` says that the output is not fresh, tries to `restore` it.
template <class FreshnessOf, class Restore>
StageState stage_state(FreshnessOf freshness, Restore restore) {
  const Freshness before = freshness();
  if (before.fresh() || !restore()) return {before, before, false};
  const Freshness now = freshness();
  return {now, before, now.fresh()};
}

/// Of all frames of a job together; those that `cache` has, unless it is null, are put back. `fresh`, unless null: is
/// told for each frame whether it is.
StageState frames_state(const Job& job, const PatchSet& scene, const OutputCache* cache,
                        std::vector<bool>* fresh = nullptr);

/// Keeps all frames of a job under their keys.
void keep_frames(const Job& job, const PatchSet& scene, const OutputCache& cache);

}  // namespace patchlight

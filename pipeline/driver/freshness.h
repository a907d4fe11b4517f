#pragma once
#include <string>

#include "pipeline/files/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Whether a stage's output matches what the job would make now.
struct Freshness {
  bool fresh = false;
  bool damaged = false;
  std::string reason;  ///< Why it does not, for people.
};

/// Of patches.h5. Reads it into `scene` if it is whole.
Freshness patches_freshness(const Job& job, PatchSet& scene);

/// Of energy.h5, and transport.h5 where the method keeps one, for the patches in `scene`.
Freshness energy_freshness(const Job& job, const PatchSet& scene);

/// Of all frames of the job, from a solution that is fresh.
Freshness frames_freshness(const Job& job, const PatchSet& scene);

}  // namespace patchlight

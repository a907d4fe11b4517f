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

/// Of energy.h5, for the patches in `scene`. Puts its key into `energy_key`.
Freshness energy_freshness(const Job& job, const PatchSet& scene, std::string& energy_key);

/// Of all frames of the job.
Freshness frames_freshness(const Job& job, const PatchSet& scene, const std::string& energy_key);

}  // namespace patchlight

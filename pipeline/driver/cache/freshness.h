#pragma once
#include <string>
#include <utility>
#include <vector>

#include "pipeline/frames/frame_list.h"
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Whether an output matches what the job would make now.
struct Freshness {
  enum class State { fresh, stale, missing, damaged };

  State state = State::fresh;
  /// For people: what changed and how, as in `solve.rays 64 -> 256`; what is missing or damaged. Empty if fresh.
  std::vector<std::string> reasons;
  std::string key;                      ///< That the job wants of it; empty where it cannot be told yet.
  std::vector<std::string> warnings{};  ///< That its stage gave when it made it.

  bool fresh() const { return state == State::fresh; }
  const char* name() const;  ///< Of the state.
  /// The reasons in a line: all, or the first and how many more.
  std::string reason(bool all) const;
};

/// Several outputs as one; those with the same reasons in one line.
class JointFreshness {
 public:
  void add(const std::string& name, const Freshness& one);
  /// Damaged if any of them is, else stale if any is not fresh. Its key is made of theirs.
  Freshness all() const;

 private:
  Freshness::State state_ = Freshness::State::fresh;
  std::vector<std::string> keys_;
  std::vector<std::pair<std::string, std::vector<std::string>>> names_;  ///< By reason.
};

/// The key that a job wants of a patches.h5 that is made from these files as they are now; empty if one is gone.
std::string import_key(const Job& job, const std::vector<SourceFile>& sources);

/// Whether a solve leaves a transport.h5.
bool keeps_transport(const Job& job, const PatchSet& scene);

/// Whether transport.h5 is there and has what the job wants of rows.
Freshness transport_freshness(const Job& job, const PatchSet& scene);

/// Of patches.h5. Reads it into `scene` if it is whole.
Freshness patches_freshness(const Job& job, PatchSet& scene);

/// Of energy.h5, and transport.h5 where the method keeps one, for the patches in `scene`.
Freshness energy_freshness(const Job& job, const PatchSet& scene);

/// Of one frame's EXR and PNG, by a solution of `scene` as the job wants it. `view_config`: the view_config_key().
Freshness frame_freshness(const Job& job, const PatchSet& scene, const Frame& frame, const std::string& view_config);

/// Of what `patchlight relight` makes of a frame.
Freshness relit_freshness(const Job& job, const PatchSet& scene, const Frame& frame, const std::string& view_config);

}  // namespace patchlight

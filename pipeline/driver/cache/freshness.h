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
  /// Messages: changed settings, as in `solve.rays 64 -> 256`; missing or damaged files. Empty if fresh.
  std::vector<std::string> reasons;
  std::string key;                      ///< Key that the job requires; empty if it is not known yet.
  std::vector<std::string> warnings{};  ///< Warnings that the stage gave when it wrote the output.

  bool fresh() const { return state == State::fresh; }
  const char* name() const;  ///< Name of the state.
  /// The reasons in one line: all of them, or the first and the number of the others.
  std::string reason(bool all) const;
};

/// Combines the freshness of several outputs; outputs with equal reasons share a line.
class JointFreshness {
 public:
  void add(const std::string& name, const Freshness& one);
  /// Damaged if any output is damaged, else stale if any is not fresh. Its key is a hash of all keys.
  Freshness all() const;

 private:
  Freshness::State state_ = Freshness::State::fresh;
  std::vector<std::string> keys_;
  std::vector<std::pair<std::string, std::vector<std::string>>> names_;  ///< By reason.
};

/// The key that a job requires of a patches.h5 made from the present content of these files; empty if a file is
/// missing.
std::string import_key(const Job& job, const std::vector<SourceFile>& sources);

/// Whether a solve writes transport.h5.
bool keeps_transport(const Job& job, const PatchSet& scene);

/// Freshness of the rows in transport.h5.
Freshness transport_freshness(const Job& job, const PatchSet& scene);

/// Freshness of patches.h5. Reads the file into `scene` if it is intact.
Freshness patches_freshness(const Job& job, PatchSet& scene);

/// Freshness of energy.h5 and, if the method writes one, transport.h5, for the patches in `scene`.
Freshness energy_freshness(const Job& job, const PatchSet& scene);

/// Freshness of one frame's EXR and PNG for a fresh solution of `scene`. `view_config`: the view_config_key().
Freshness frame_freshness(const Job& job, const PatchSet& scene, const Frame& frame, const std::string& view_config);

/// Freshness of a relit frame.
Freshness relit_freshness(const Job& job, const PatchSet& scene, const Frame& frame, const std::string& view_config);

}  // namespace patchlight

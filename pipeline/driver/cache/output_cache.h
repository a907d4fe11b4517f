#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "pipeline/frames/frame_list.h"
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Outputs of earlier settings, each a hard link named by its key, so that what stands in the output folder too takes
/// no space, and nothing is half there whenever a run is killed. What is taken from here is checked as any output is:
/// its key and hashes stand in it. Where links cannot be made nothing is kept.
class OutputCache {
 public:
  /// `limit`: most bytes that files which stand nowhere else may take; 0: nothing is kept or restored.
  OutputCache(std::filesystem::path folder, std::uint64_t limit);

  void keep(const std::filesystem::path& file, const std::string& name) const;
  /// Puts what is kept under a name in the place of `file`. Returns whether there was something.
  bool restore(const std::string& name, const std::filesystem::path& file) const;
  /// Removes what was used longest ago until the limit is kept.
  void trim() const;
  /// Removes all that is kept, and the folder if nothing else is in it. Returns how many bytes that frees.
  std::uint64_t clear() const;

  void keep_patches(const Job& job, const PatchSet& scene) const;
  /// With the key of the files that an earlier import of the same scene file read.
  bool restore_patches(const Job& job) const;
  void keep_energy(const Job& job, const PatchSet& scene) const;
  bool restore_energy(const Job& job, const PatchSet& scene) const;
  void keep_frame(const Frame& frame, const std::string& key) const;
  bool restore_frame(const Frame& frame, const std::string& key) const;

 private:
  std::uint64_t remove_beyond(std::uint64_t limit) const;

  std::filesystem::path folder_;
  std::uint64_t limit_ = 0;
};

/// Where a job keeps outputs of earlier settings.
std::filesystem::path cache_folder(const Job& job);

}  // namespace patchlight

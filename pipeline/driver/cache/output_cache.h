#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "pipeline/frames/frame_list.h"
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Keeps outputs of earlier settings as hard links named by their keys. A file that is also in the output folder takes
/// no extra space, and a killed run leaves no partial file. Restored files are checked like any output, by their key
/// and hashes. On file systems without hard links nothing is kept.
class OutputCache {
 public:
  /// `limit`: maximum bytes of files that exist only here; 0: nothing is kept or restored.
  OutputCache(std::filesystem::path folder, std::uint64_t limit);

  void keep(const std::filesystem::path& file, const std::string& name) const;
  /// Replaces `file` by the entry of a name. Returns whether there was one.
  bool restore(const std::string& name, const std::filesystem::path& file) const;
  /// Removes the least recently used entries down to the limit.
  void trim() const;
  /// Removes all entries, and the folder if it is then empty. Returns the bytes freed.
  std::uint64_t clear() const;

  void keep_patches(const Job& job, const PatchSet& scene) const;
  /// Restores patches.h5 by the source files of an earlier import of the same scene file.
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

/// The folder where a job keeps outputs of earlier settings.
std::filesystem::path cache_folder(const Job& job);

}  // namespace patchlight

#pragma once
#include <filesystem>

namespace patchlight {

/// A name beside `target` to write under until all is well. Makes the folder.
/// Without commit() the destructor removes what was written; `target` is never touched before.
class TemporaryFile {
 public:
  /// Throws: Error (cannot_create) if the folder cannot be made.
  explicit TemporaryFile(std::filesystem::path target);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& target() const { return target_; }

  /// Renames onto the target. Throws: Error (io_error).
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path path_;
};

}  // namespace patchlight

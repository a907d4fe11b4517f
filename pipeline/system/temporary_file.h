#pragma once
#include <filesystem>
#include <string>

namespace patchlight {

/// What names of temporary files begin with.
inline constexpr const char* kTemporaryPrefix = ".patchlight-";

/// A name to write `target` under until all is well, in `folder` of the same file system, or else beside it. Makes the
/// folders, and removes temporary files that killed processes left in the one. The name of a file holds its process and
/// a hash of the machine's boot and the container (the namespace of process numbers): only processes of the same boot
/// and container judge whether the writer is dead. Files from elsewhere stay, on network file systems too, which need
/// no locks for this.
/// Without commit() the destructor removes what was written; `target` is never touched before.
class TemporaryFile {
 public:
  /// Throws: Error (cannot_create) if a folder cannot be made.
  explicit TemporaryFile(std::filesystem::path target, const std::filesystem::path& folder = {});
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

/// Writes a text file whole or not at all. Throws: Error (cannot_create, io_error).
void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace patchlight

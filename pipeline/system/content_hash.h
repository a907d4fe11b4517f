#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace patchlight {

/// Accumulates typed values into a 128-bit XXH3 key. The same values in the same order give the same key on any
/// machine.
class KeyHasher {
 public:
  KeyHasher();
  ~KeyHasher();
  KeyHasher& add(std::string_view text);
  KeyHasher& add(const char* text) { return add(std::string_view(text)); }
  KeyHasher& add(double value);
  KeyHasher& add(std::int64_t value);
  KeyHasher& add(int value) { return add(static_cast<std::int64_t>(value)); }
  KeyHasher& add(bool value) { return add(static_cast<std::int64_t>(value)); }
  std::string hex() const;  ///< 32 hex digits.

 private:
  void* state_;
};

/// Hash of raw bytes, 32 hex digits.
std::string hash_bytes(const void* data, std::size_t size);

/// Hash of a file's content, or of its first `size` bytes. Throws: Error (missing_input, io_error).
std::string hash_file(const std::filesystem::path& file, std::uintmax_t size = UINTMAX_MAX);

}  // namespace patchlight

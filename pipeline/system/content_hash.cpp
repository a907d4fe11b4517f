#include "pipeline/system/content_hash.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <memory>

#include "pipeline/model/error.h"

namespace patchlight {

namespace {

XXH3_state_t* state_of(void* state) {
  return static_cast<XXH3_state_t*>(state);
}

std::string to_hex(XXH128_hash_t hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

KeyHasher::KeyHasher() : state_(XXH3_createState()) {
  XXH3_128bits_reset(state_of(state_));
}

KeyHasher::~KeyHasher() {
  XXH3_freeState(state_of(state_));
}

KeyHasher& KeyHasher::add(std::int64_t value) {
  std::array<unsigned char, 8> bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<unsigned char>(std::uint64_t(value) >> (8 * i));
  XXH3_128bits_update(state_of(state_), bytes.data(), bytes.size());
  return *this;
}

KeyHasher& KeyHasher::add(std::string_view text) {
  add(static_cast<std::int64_t>(text.size()));
  XXH3_128bits_update(state_of(state_), text.data(), text.size());
  return *this;
}

KeyHasher& KeyHasher::add(double value) {
  return add(std::bit_cast<std::int64_t>(value == 0 ? 0.0 : value));
}

std::string KeyHasher::hex() const {
  return to_hex(XXH3_128bits_digest(state_of(state_)));
}

std::string hash_bytes(const void* data, std::size_t size) {
  return to_hex(XXH3_128bits(data, size));
}

std::string hash_file(const std::filesystem::path& file, std::uintmax_t size) {
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), std::fclose);
  if (!stream) throw Error(ExitCode::missing_input, "cannot open the file", file.string(), "check the path");
  std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(), XXH3_freeState);
  XXH3_128bits_reset(state.get());
  std::array<char, 1 << 16> buffer;
  while (const std::size_t count =
             std::fread(buffer.data(), 1, std::size_t(std::min<std::uintmax_t>(size, buffer.size())), stream.get())) {
    XXH3_128bits_update(state.get(), buffer.data(), count);
    size -= count;
  }
  if (std::ferror(stream.get()))
    throw Error(ExitCode::io_error, "cannot read the file", file.string(), "check the disk and the path");
  return to_hex(XXH3_128bits_digest(state.get()));
}

}  // namespace patchlight

#include "importers/gltf/file/gltf_file.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <fstream>

#include "pipeline/model/error.h"
#include "pipeline/system/content_hash.h"

namespace patchlight {
namespace {

constexpr std::uintmax_t kMaxFileSize = 4ull << 30;  // the largest GLB
constexpr std::size_t kMaxJsonSize = 512ull << 20;   // parsed JSON takes many times its size in memory
constexpr std::uint32_t kMagic = 0x46546C67;         // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;     // "JSON"
constexpr std::uint32_t kBinaryChunk = 0x004E4942;   // "BIN"

std::shared_ptr<const Bytes> read_whole_file(const std::filesystem::path& path, const std::string& where) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw Error(ExitCode::missing_input, fmt::format("there is no file '{}'", path.string()), where,
                "check its name, or copy it there");
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw Error(ExitCode::bad_data, fmt::format("'{}' is not a regular file", path.string()), where,
                "set the path to a file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size > kMaxFileSize) {
    throw Error(ExitCode::over_limit, fmt::format("'{}' is larger than 4 GiB", path.string()), where,
                "split the scene; this limit is fixed");
  }
  std::ifstream stream(path, std::ios::binary);
  auto bytes = std::make_shared<Bytes>(error ? 0 : size);
  stream.read(reinterpret_cast<char*>(bytes->data()), static_cast<std::streamsize>(bytes->size()));
  if (error || !stream) {
    throw Error(ExitCode::io_error, fmt::format("cannot read '{}'", path.string()), where, "check its permissions");
  }
  return bytes;
}

std::uint32_t word_at(const Bytes& bytes, std::size_t offset) {
  return static_cast<std::uint32_t>(bytes[offset]) | static_cast<std::uint32_t>(bytes[offset + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[offset + 2]) << 16 | static_cast<std::uint32_t>(bytes[offset + 3]) << 24;
}

[[noreturn]] void refuse_glb(const GltfFile& file, const std::string& what) {
  throw Error(ExitCode::bad_data, what, file.name, "the file is damaged or truncated; export or copy it again");
}

void split_glb(GltfFile& file) {
  const Bytes& bytes = *file.content;
  if (bytes.size() < 20) refuse_glb(file, "the GLB header is truncated");
  if (word_at(bytes, 4) != 2)
    refuse_glb(file, fmt::format("GLB version {} is not supported, only version 2", word_at(bytes, 4)));
  const std::size_t length = word_at(bytes, 8);
  if (length > bytes.size()) {
    refuse_glb(file,
               fmt::format("the GLB header gives a length of {} bytes, but the file has {}", length, bytes.size()));
  }
  const auto text = reinterpret_cast<const char*>(bytes.data());
  for (std::size_t offset = 12, chunk = 0; offset < length; ++chunk) {
    if (length - offset < 8) refuse_glb(file, fmt::format("the header of GLB chunk {} is truncated", chunk));
    const std::size_t size = word_at(bytes, offset);
    const std::uint32_t type = word_at(bytes, offset + 4);
    offset += 8;
    if (size > length - offset) {
      refuse_glb(file, fmt::format("GLB chunk {} has a length of {} bytes, but only {} are left in the file", chunk,
                                   size, length - offset));
    }
    if (chunk == 0 && type != kJsonChunk) refuse_glb(file, "the first GLB chunk is not JSON");
    if (chunk == 0) file.json = std::string_view(text + offset, size);
    if (type == kBinaryChunk && !file.has_binary_chunk) {
      file.binary_chunk = std::span(bytes).subspan(offset, size);
      file.has_binary_chunk = true;
    }
    offset += size;
  }
  if (file.json.empty()) refuse_glb(file, "the GLB has no JSON chunk");
}

void record_source(GltfFile& file, const std::string& path, const Bytes& bytes) {
  file.sources.push_back({path, hash_bytes(bytes.data(), bytes.size())});
}

}  // namespace

GltfFile read_gltf_file(const std::filesystem::path& path) {
  GltfFile file;
  file.path = path;
  file.name = path.filename().string();
  file.content = read_whole_file(path, "scene");
  record_source(file, file.name, *file.content);

  const Bytes& bytes = *file.content;
  if (bytes.size() >= 4 && word_at(bytes, 0) == kMagic) {
    split_glb(file);
  } else {
    file.json = std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  if (file.json.size() > kMaxJsonSize) {
    throw Error(ExitCode::over_limit, "the scene's JSON is larger than 512 MiB", file.name,
                "keep buffers and images in separate files; this limit is fixed");
  }
  return file;
}

std::shared_ptr<const Bytes> read_uri(GltfFile& file, std::string_view uri, const std::string& where) {
  const std::string place = file.name + ", " + where;
  if (is_data_uri(uri)) return std::make_shared<const Bytes>(decode_data_uri(uri, place));

  const std::filesystem::path relative = confined_path(uri, place);
  std::shared_ptr<const Bytes>& bytes = file.files[relative];
  if (!bytes) {
    bytes = read_whole_file(file.path.parent_path() / relative, place);
    record_source(file, relative.generic_string(), *bytes);
  }
  return bytes;
}

std::shared_ptr<const Bytes> read_input(GltfFile& file, const std::filesystem::path& path, const std::string& source,
                                        const std::string& where) {
  std::shared_ptr<const Bytes> bytes = read_whole_file(path, where);
  record_source(file, source, *bytes);
  return bytes;
}

}  // namespace patchlight

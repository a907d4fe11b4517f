#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/math.h"

namespace patchlight {

/// Channels of an EXR besides R, G and B.
struct ImageLayer {
  std::string name;
  std::string channels;  ///< RGB, XYZ or a single letter; an EXR channel is named `name`, a dot and its letter.
  /// [height * width] Colours or vectors, floats, or integers.
  std::variant<std::vector<Color>, std::vector<float>, std::vector<std::uint32_t>> values;
};

/// Scene-linear pixels, rows from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Color> pixels;                    ///< [height * width].
  std::map<std::string, std::string> metadata;  ///< Text attributes of the file's header.
  std::vector<ImageLayer> layers{};
};

/// How an EXR is stored. Layers other than colours are always 32-bit floats or integers.
struct ExrFormat {
  std::string pixel_type = "half";  ///< Of colours: half or float.
  std::string compression = "zip";  ///< One of kExrCompressions.
};

/// Writes a single-part EXR with channels R, G, B and those of the layers, and `metadata` as header attributes. Atomic:
/// writes a temporary file in `temporary_folder` (by default next to `file`) and renames it.
/// Throws: Error (cannot_create, io_error).
void write_exr(const std::filesystem::path& file, const Image& image,
               const std::filesystem::path& temporary_folder = {}, const ExrFormat& format = {});

/// Writes display-encoded values in [0,1] as 8-bit PNG, in the same way.
/// Throws: Error (cannot_create, io_error).
void write_png(const std::filesystem::path& file, const Image& image,
               const std::filesystem::path& temporary_folder = {});

/// Reads channels R, G and B of an EXR, and the header's text attributes.
/// Throws: Error (missing_input, bad_data).
Image read_exr(const std::filesystem::path& file);

/// The same, with all layers of the kinds that write_exr() writes, sorted by name.
Image read_exr_layers(const std::filesystem::path& file);

/// The same, without pixels and values.
Image read_exr_header(const std::filesystem::path& file);

}  // namespace patchlight

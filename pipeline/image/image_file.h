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

/// Channels of an EXR beside R, G and B.
struct ImageLayer {
  std::string name;
  std::string channels;  ///< A letter each, after the name and a dot: RGB, XYZ, or one of one value.
  /// [height * width]: three values each, one, or a number.
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

/// How an EXR is stored. Layers that are not colours are whole floats, and numbers whole numbers, in any case.
struct ExrFormat {
  std::string pixel_type = "half";  ///< half or float.
  std::string compression = "zip";  ///< One of kExrCompressions.
};

/// Writes an EXR of one part, channels R, G, B and those of the layers, with `metadata` as header attributes. Atomic;
/// until it is whole it stands in `temporary_folder`, or beside `file`. Throws: Error (cannot_create, io_error).
void write_exr(const std::filesystem::path& file, const Image& image,
               const std::filesystem::path& temporary_folder = {}, const ExrFormat& format = {});

/// Writes 8-bit PNG of display-ready values in [0,1], in the same way.
/// Throws: Error (cannot_create, io_error).
void write_png(const std::filesystem::path& file, const Image& image,
               const std::filesystem::path& temporary_folder = {});

/// Reads channels R, G, B of an EXR, by name, with the header's text attributes.
/// Throws: Error (missing_input, bad_data).
Image read_exr(const std::filesystem::path& file);

/// The same with all layers of the kinds that write_exr() writes, by growing name.
Image read_exr_layers(const std::filesystem::path& file);

/// The same without pixels and values, and without the memory for them.
Image read_exr_header(const std::filesystem::path& file);

}  // namespace patchlight

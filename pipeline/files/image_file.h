#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// Scene-linear pixels, rows from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Color> pixels;                    ///< [height * width].
  std::map<std::string, std::string> metadata;  ///< Text attributes of the file's header.
};

/// Writes half-float EXR, channels R, G, B, with `metadata` as header attributes. Atomic; until it is whole it stands
/// in `temporary_folder`, or beside `file`. Throws: Error (cannot_create, io_error).
void write_exr(const std::filesystem::path& file, const Image& image,
               const std::filesystem::path& temporary_folder = {});

/// Writes 8-bit PNG of display-ready values in [0,1], in the same way.
/// Throws: Error (cannot_create, io_error).
void write_png(const std::filesystem::path& file, const Image& image,
               const std::filesystem::path& temporary_folder = {});

/// Reads channels R, G, B of an EXR, by name, with the header's text attributes.
/// Throws: Error (missing_input, bad_data).
Image read_exr(const std::filesystem::path& file);

/// The same without pixels, and without the memory for them.
Image read_exr_header(const std::filesystem::path& file);

}  // namespace patchlight

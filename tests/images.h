#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "pipeline/system/on_demand.h"

/// Image files by OpenImageIO. It is loaded by the tests that need it: that takes half a second.
namespace patchlight::test {

enum class PixelType { byte, floating };

/// [height * width * channels] Values, rows from the top; bytes as fractions of 255.
struct Pixels {
  int width = 0, height = 0, channels = 0;
  std::vector<float> values{};
};

/// What stands in the header of an EXR.
struct ImageHeader {
  std::map<std::string, std::string> channel_types;  ///< By channel: half, float or uint.
  std::map<std::string, std::string> text;           ///< Attributes that are text.
  int parts = 0;
};

extern "C" {
/// Writes a file of the format of its extension, in tiles of `tile` pixels unless that is 0. Alpha is unassociated.
/// Throws: std::runtime_error.
void write_pixels(const std::filesystem::path& file, const Pixels& pixels, PixelType type, int tile);

/// Throws: std::runtime_error.
void read_pixels(const std::filesystem::path& file, Pixels& pixels);

/// Throws: std::runtime_error.
void read_image_header(const std::filesystem::path& file, ImageHeader& header);
}

inline void write_image(const std::filesystem::path& file, const Pixels& pixels, PixelType type, int tile = 0) {
  on_demand<decltype(write_pixels)>("test-images", "write_pixels")(file, pixels, type, tile);
}

inline Pixels read_image(const std::filesystem::path& file) {
  Pixels pixels;
  on_demand<decltype(read_pixels)>("test-images", "read_pixels")(file, pixels);
  return pixels;
}

inline ImageHeader image_header(const std::filesystem::path& file) {
  ImageHeader header;
  on_demand<decltype(read_image_header)>("test-images", "read_image_header")(file, header);
  return header;
}

}  // namespace patchlight::test

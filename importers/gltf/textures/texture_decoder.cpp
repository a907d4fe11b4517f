#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "importers/gltf/textures/texture_reader.h"
#include "importers/gltf/textures/webp.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr std::int64_t kMaxTexels = 8192 * 8192;
constexpr int kRowsAtOnce = 64;

[[noreturn]] void refuse(const std::string& what, const std::string& place) {
  throw Error(ExitCode::bad_data, what, place, "save the texture as PNG, JPEG or WebP again");
}

/// A file name whose extension makes OpenImageIO choose the right reader, from the image's first bytes.
const char* format_name(std::span<const unsigned char> bytes, const std::string& place) {
  constexpr std::array<unsigned char, 8> png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  constexpr std::array<unsigned char, 3> jpeg{0xff, 0xd8, 0xff};
  const auto begins_with = [&](const auto& magic) {
    return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  if (begins_with(png)) return "image.png";
  if (begins_with(jpeg)) return "image.jpg";
  if (is_webp(bytes)) return "image.webp";
  refuse(bytes.empty() ? "the texture has no data" : "the texture is none of PNG, JPEG and WebP", place);
}

std::vector<float> decoding_table(TextureEncoding encoding) {
  std::vector<float> table(65536);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double value = static_cast<double>(i) / 65535.0;
    const double linear = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
    table[i] = static_cast<float>(encoding == TextureEncoding::srgb ? linear : value);
  }
  return table;
}

/// Texels as 0xRRGGBB, or alpha alone. Grey images have one or two channels.
void append_texels(std::span<const std::uint16_t> values, std::size_t channels, TextureEncoding encoding,
                   std::vector<std::int32_t>& texels) {
  const auto byte = [](std::uint16_t value) { return (value + 128) / 257; };
  for (std::size_t i = 0; i < values.size(); i += channels) {
    if (encoding == TextureEncoding::alpha) {
      texels.push_back(byte(values[i + channels - 1]));
      continue;
    }
    const std::size_t step = channels < 3 ? 0 : 1;
    texels.push_back(byte(values[i]) << 16 | byte(values[i + step]) << 8 | byte(values[i + 2 * step]));
  }
}

void check_size(std::int64_t width, std::int64_t height, std::int64_t texels_left, const std::string& place) {
  if (width <= 0 || height <= 0) refuse("the texture holds no colours", place);
  if (width > std::min(kMaxTexels, texels_left) / height) {
    throw Error(ExitCode::over_limit, fmt::format("a texture of {} x {} texels is too large", width, height), place,
                "scale it down; a texture may have 8192 x 8192 texels, all textures 2^30, and these limits are fixed");
  }
}

/// Checks a WebP image, which OpenImageIO decodes when it opens it, and takes away the alpha of one that is read for
/// its colours: replaces `bytes` by those in `colors`.
void prepare_webp(TextureEncoding encoding, const std::string& place, std::int64_t texels_left,
                  std::vector<unsigned char>& colors, std::span<const unsigned char>& bytes) {
  const WebpHeader header = webp_header(bytes);
  check_size(header.width, header.height, texels_left, place);
  if (header.is_animated) refuse("the texture is an animated WebP image", place);
  if (encoding == TextureEncoding::alpha && header.has_alpha) return;
  colors = webp_without_alpha(bytes);
  bytes = colors;
}

/// Refuses a JPEG that ends too early. OpenImageIO decodes it with grey in place of what is missing, and keeps the
/// warning of libjpeg: "Premature end of JPEG file", or "Corrupt JPEG data: premature end of data segment".
void check_end(const OIIO::ImageInput& image, const std::string& place) {
  const std::string warning = image.geterror();
  if (warning.find("remature end") != std::string::npos)
    refuse(fmt::format("the texture is damaged: {}", warning), place);
}

}  // namespace

void decode_texture(std::span<const unsigned char> bytes, TextureEncoding encoding, const std::string& place,
                    std::int64_t& texels_left, Texture* kept, Vec3d& mean) {
  const char* const name = format_name(bytes, place);
  std::vector<unsigned char> colors;
  if (is_webp(bytes)) prepare_webp(encoding, place, texels_left, colors, bytes);
  OIIO::Filesystem::IOMemReader memory(const_cast<unsigned char*>(bytes.data()), bytes.size());
  OIIO::ImageSpec config;
  config["oiio:UnassociatedAlpha"] = 1;
  OIIO::Filesystem::IOProxy* proxy = &memory;
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const auto image = OIIO::ImageInput::open(name, &config, proxy);
  if (!image) refuse(fmt::format("the texture cannot be decoded: {}", OIIO::geterror()), place);

  const OIIO::ImageSpec& spec = image->spec();
  if (spec.nchannels < 1 || spec.nchannels > 4) refuse("the texture holds no colours", place);
  check_size(spec.width, spec.height, texels_left, place);
  const std::int64_t texels = std::int64_t{spec.width} * spec.height;
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  if (encoding == TextureEncoding::alpha && channels % 2 != 0) {
    mean = Vec3d(1.0);
    return;
  }
  texels_left -= texels;

  const std::vector<float> table = decoding_table(encoding);
  std::vector<std::uint16_t> rows(static_cast<std::size_t>(spec.width) * kRowsAtOnce * channels);
  std::array<double, 4> sums{};
  if (kept) {
    kept->width = spec.width;
    kept->height = spec.height;
    kept->texels.reserve(static_cast<std::size_t>(texels));
  }
  for (int y = 0; y < spec.height; y += kRowsAtOnce) {
    const int end = std::min(y + kRowsAtOnce, spec.height);
    if (!image->read_scanlines(0, 0, spec.y + y, spec.y + end, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT16,
                               rows.data())) {
      refuse(fmt::format("the texture is damaged: {}", image->geterror()), place);
    }
    const std::size_t values = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(end - y) * channels;
    for (std::size_t i = 0; i < values; ++i) sums[i % channels] += table[rows[i]];
    if (kept) append_texels(std::span(rows).first(values), channels, encoding, kept->texels);
  }
  check_end(*image, place);
  for (double& sum : sums) sum /= static_cast<double>(texels);
  if (encoding == TextureEncoding::alpha)
    mean = Vec3d(sums[channels - 1]);
  else
    mean = channels < 3 ? Vec3d(sums[0]) : Vec3d(sums[0], sums[1], sums[2]);
}

}  // namespace patchlight

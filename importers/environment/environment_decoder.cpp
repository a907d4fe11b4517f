#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <vector>

#include "importers/environment/environment.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr std::int64_t kMaxTexels = std::int64_t{1} << 27;  // texels: 16k x 8k
constexpr int kMaxSide = 1 << 16;
constexpr int kRowsAtOnce = 64;
constexpr double kLeastRadiance = -0.01;  // x mean: less is a fault of the image, not of its resampling or compression

[[noreturn]] void refuse(const std::string& what, const std::string& place) {
  throw Error(ExitCode::bad_data, what, place, "save the image as Radiance .hdr or OpenEXR again");
}

/// OpenImageIO's name for the format, from the file's first bytes.
const char* format_name(const std::filesystem::path& file, const std::string& place) {
  std::array<char, 4> magic{};
  std::ifstream(file, std::ios::binary).read(magic.data(), magic.size());
  if (magic[0] == '#' && magic[1] == '?') return "hdr";
  if (magic == std::array<char, 4>{'\x76', '\x2f', '\x31', '\x01'}) return "openexr";
  refuse("the environment's image is neither Radiance .hdr nor OpenEXR", place);
}

/// Negative radiance of an image.
struct Negatives {
  std::int64_t texels = 0;
  double least = 0.0;
  int x = 0, y = 0;  ///< Column and row of the least.
};

[[noreturn]] void refuse_radiance(double radiance, int x, int y, const std::string& limit, const std::string& place) {
  throw Error(
      ExitCode::bad_data,
      fmt::format("the environment's image has radiance {} at column {}, row {}; it must be {}", radiance, x, y, limit),
      place, "correct the image, for example with the Clamp filter of an image editor");
}

/// The radiance of a texel of one or three channels, with 0 in place of negative values, which are added to
/// `negatives`.
Vec3d read_texel(const float* values, std::size_t channels, int x, int y, Negatives& negatives,
                 const std::string& place) {
  Vec3d color(values[0], values[channels == 3 ? 1 : 0], values[channels == 3 ? 2 : 0]);
  bool negative = false;
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(color[k])) refuse_radiance(color[k], x, y, "finite", place);
    if (color[k] >= 0.0) continue;
    if (color[k] < negatives.least) negatives = {negatives.texels, color[k], x, y};
    negative = true;
    color[k] = 0.0;
  }
  negatives.texels += negative;
  return color;
}

void check_negatives(const Negatives& negatives, const std::vector<Vec3d>& sums, std::int64_t texels,
                     const std::string& place) {
  double mean = 0.0;
  for (const Vec3d& sum : sums) mean += (sum.x + sum.y + sum.z) / (3.0 * static_cast<double>(texels));
  if (negatives.least < kLeastRadiance * mean)
    refuse_radiance(negatives.least, negatives.x, negatives.y,
                    fmt::format("at least -1% of the image's mean, which is {:.3g}", mean), place);
}

}  // namespace

void decode_environment(const std::filesystem::path& file, const std::string& place, int max_columns, Environment& sky,
                        std::int64_t& negative_texels) {
  const auto image = OIIO::ImageInput::create(format_name(file, place));
  OIIO::ImageSpec spec;
  if (!image || !image->open(file.string(), spec))
    refuse(fmt::format("the environment's image cannot be decoded: {}", image ? image->geterror() : OIIO::geterror()),
           place);
  const std::int64_t texels = std::int64_t{spec.width} * spec.height;
  if (texels <= 0 || spec.nchannels < 1 || spec.nchannels > 64)
    refuse("the environment's image holds no colours", place);
  if (spec.nchannels >= 3 &&
      (spec.channelnames[0] != "R" || spec.channelnames[1] != "G" || spec.channelnames[2] != "B"))
    refuse("the first channels of the environment's image are not R, G and B", place);
  if (texels > kMaxTexels || spec.width > kMaxSide || spec.height > kMaxSide)
    throw Error(ExitCode::over_limit,
                fmt::format("an environment's image of {} x {} texels is too large", spec.width, spec.height), place,
                "scale it down to 16,384 x 8,192 texels; this limit is fixed");

  const auto reduced = [](int size, int max_size) { return size / ((size + max_size - 1) / max_size); };
  sky.width = reduced(spec.width, max_columns);
  sky.height = reduced(spec.height, max_columns / 2);
  std::vector<Vec3d> sums(static_cast<std::size_t>(sky.width) * static_cast<std::size_t>(sky.height), Vec3d(0.0));
  std::vector<int> counts(sums.size());
  Negatives negatives;
  const std::size_t channels = spec.nchannels < 3 ? 1 : 3;
  const int rows_at_once = spec.tile_width > 0 ? spec.height : kRowsAtOnce;
  std::vector<float> rows(static_cast<std::size_t>(spec.width) * rows_at_once * channels);
  for (int y = 0; y < spec.height; y += rows_at_once) {
    const int end = std::min(y + rows_at_once, spec.height);
    const bool complete =
        spec.tile_width > 0 ? image->read_image(0, 0, 0, static_cast<int>(channels), OIIO::TypeDesc::FLOAT, rows.data())
                            : image->read_scanlines(0, 0, spec.y + y, spec.y + end, 0, 0, static_cast<int>(channels),
                                                    OIIO::TypeDesc::FLOAT, rows.data());
    if (!complete) refuse(fmt::format("the environment's image is damaged: {}", image->geterror()), place);
    for (int row = y; row < end; ++row)
      for (int x = 0; x < spec.width; ++x) {
        const float* values = rows.data() + (static_cast<std::size_t>(row - y) * spec.width + x) * channels;
        const std::int64_t to =
            std::int64_t{row} * sky.height / spec.height * sky.width + std::int64_t{x} * sky.width / spec.width;
        sums[static_cast<std::size_t>(to)] += read_texel(values, channels, x, row, negatives, place);
        ++counts[static_cast<std::size_t>(to)];
      }
  }
  check_negatives(negatives, sums, texels, place);
  negative_texels = negatives.texels;
  for (std::size_t i = 0; i < sums.size(); ++i)
    sky.texels.emplace_back(Vec3f(sums[i] / double(std::max(counts[i], 1))));
}

}  // namespace patchlight

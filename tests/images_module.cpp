#include <OpenImageIO/imageio.h>

#include <stdexcept>

#include "tests/images.h"

namespace patchlight::test {
namespace {

std::unique_ptr<OIIO::ImageInput> open(const std::filesystem::path& file) {
  auto input = OIIO::ImageInput::open(file.string());
  if (!input) throw std::runtime_error(OIIO::geterror());
  return input;
}

}  // namespace

extern "C" {

void write_pixels(const std::filesystem::path& file, const Pixels& pixels, PixelType type, int tile) {
  OIIO::ImageSpec spec(pixels.width, pixels.height, pixels.channels,
                       type == PixelType::byte ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT);
  spec["oiio:UnassociatedAlpha"] = 1;
  spec.tile_width = spec.tile_height = tile;
  const auto image = OIIO::ImageOutput::create(file.string());
  if (!image || !image->open(file.string(), spec) || !image->write_image(OIIO::TypeDesc::FLOAT, pixels.values.data()) ||
      !image->close())
    throw std::runtime_error("cannot write " + file.string());
}

void read_pixels(const std::filesystem::path& file, Pixels& pixels) {
  const auto input = open(file);
  const OIIO::ImageSpec& spec = input->spec();
  pixels = {spec.width, spec.height, spec.nchannels, std::vector<float>(spec.image_pixels() * spec.nchannels)};
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels.values.data()))
    throw std::runtime_error(input->geterror());
}

void read_image_header(const std::filesystem::path& file, ImageHeader& header) {
  const auto input = open(file);
  const OIIO::ImageSpec& spec = input->spec();
  for (int i = 0; i < spec.nchannels; ++i)
    header.channel_types[spec.channelnames[std::size_t(i)]] = spec.channelformat(i).c_str();
  for (const OIIO::ParamValue& attribute : spec.extra_attribs)
    if (attribute.type() == OIIO::TypeString) header.text[attribute.name().string()] = attribute.get_string();
  for (header.parts = 1; input->seek_subimage(header.parts, 0);) ++header.parts;
}

}  // extern "C"
}  // namespace patchlight::test

#include "pipeline/files/image_file.h"

#include <OpenImageIO/imageio.h>

#include "pipeline/files/temporary_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

constexpr int kMaxSide = 65536;

void write_image(const fs::path& file, const Image& image, const OIIO::ImageSpec& spec) {
  TemporaryFile temporary(file);
  auto output = OIIO::ImageOutput::create(temporary.path().string());
  if (!output || !output->open(temporary.path().string(), spec))
    throw Error(ExitCode::cannot_create, "cannot create the image: " + (output ? output->geterror() : OIIO::geterror()),
                file.string(), "check that its folder is writable");
  if (!output->write_image(OIIO::TypeDesc::FLOAT, image.pixels.data()) || !output->close())
    throw Error(ExitCode::io_error, "cannot write the image: " + output->geterror(), file.string(),
                "check the space left on the disk");
  temporary.commit();
}

std::unique_ptr<OIIO::ImageInput> open_exr(const fs::path& file) {
  if (std::error_code fault; !fs::exists(file, fault))
    throw Error(ExitCode::missing_input, "missing image", file.string(), "check the path");
  auto input = OIIO::ImageInput::open(file.string());
  if (!input || std::string(input->format_name()) != "openexr") {
    const std::string reason = input ? std::string("it is ") + input->format_name() : OIIO::geterror();
    throw Error(ExitCode::bad_data, "not a readable EXR: " + reason, file.string(), "render it again");
  }
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width < 1 || spec.height < 1 || spec.width > kMaxSide || spec.height > kMaxSide || spec.deep)
    throw Error(ExitCode::bad_data, "an EXR of unexpected size", file.string(), "render it again");
  return input;
}

std::map<std::string, std::string> text_attributes(const OIIO::ImageSpec& spec) {
  std::map<std::string, std::string> texts;
  for (const auto& attribute : spec.extra_attribs)
    if (attribute.type() == OIIO::TypeDesc::STRING) texts[attribute.name().string()] = attribute.get_string();
  return texts;
}

}  // namespace

void write_exr(const fs::path& file, const Image& image) {
  OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::HALF);
  spec.channelnames = {"R", "G", "B"};
  spec.attribute("compression", "zip");
  spec.attribute("oiio:ColorSpace", "Linear");
  for (const auto& [name, value] : image.metadata) spec.attribute(name, value);
  write_image(file, image, spec);
}

void write_png(const fs::path& file, const Image& image) {
  OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("png:compressionLevel", 6);
  write_image(file, image, spec);
}

Image read_exr(const fs::path& file) {
  const auto input = open_exr(file);
  const OIIO::ImageSpec spec = input->spec();
  Image image{spec.width, spec.height, {}, text_attributes(spec)};
  std::array<int, 3> channels{};
  for (int k = 0; k < 3; ++k) {
    channels[k] = spec.channelindex(std::string(1, "RGB"[k]));
    if (channels[k] < 0)
      throw Error(ExitCode::bad_data, "an EXR without channels R, G and B", file.string(), "name another image");
  }
  const std::size_t count = std::size_t(spec.width) * spec.height;
  std::vector<float> values(count * spec.nchannels);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()))
    throw Error(ExitCode::bad_data, "a damaged EXR: " + input->geterror(), file.string(), "render it again");
  image.pixels.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k) image.pixels[i][k] = values[i * spec.nchannels + channels[k]];
  return image;
}

}  // namespace patchlight

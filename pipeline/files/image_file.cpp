#include "pipeline/files/image_file.h"

#include <OpenImageIO/imageio.h>

#include <array>
#include <fstream>

#include "pipeline/files/temporary_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

constexpr int kMaxSide = 65536;

void write_image(const fs::path& file, const Image& image, const OIIO::ImageSpec& spec,
                 const fs::path& temporary_folder) {
  TemporaryFile temporary(file, temporary_folder);
  auto output = OIIO::ImageOutput::create(temporary.path().string());
  if (!output || !output->open(temporary.path().string(), spec))
    throw Error(ExitCode::cannot_create, "cannot create the image: " + (output ? output->geterror() : OIIO::geterror()),
                file.string(), "check that its folder is writable");
  if (!output->write_image(OIIO::TypeDesc::FLOAT, image.pixels.data()) || !output->close())
    throw Error(ExitCode::io_error, "cannot write the image: " + output->geterror(), file.string(),
                "check the space left on the disk");
  temporary.commit();
}

bool begins_as_exr(const fs::path& file) {
  std::error_code fault;
  if (!fs::is_regular_file(file, fault)) return false;
  std::array<char, 4> magic{};
  std::ifstream(file, std::ios::binary).read(magic.data(), magic.size());
  return magic == std::array<char, 4>{0x76, 0x2f, 0x31, 0x01};
}

std::unique_ptr<OIIO::ImageInput> open_exr(const fs::path& file) {
  if (std::error_code fault; !fs::exists(file, fault))
    throw Error(ExitCode::missing_input, "missing image", file.string(), "check the path");
  if (!begins_as_exr(file)) throw Error(ExitCode::bad_data, "not an EXR", file.string(), "render it again");
  auto input = OIIO::ImageInput::create("openexr");
  OIIO::ImageSpec spec;
  if (!input || !input->open(file.string(), spec))
    throw Error(ExitCode::bad_data, "not a readable EXR: " + (input ? input->geterror() : OIIO::geterror()),
                file.string(), "render it again");
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

void write_exr(const fs::path& file, const Image& image, const fs::path& temporary_folder) {
  OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::HALF);
  spec.channelnames = {"R", "G", "B"};
  spec.attribute("compression", "zip");
  spec.attribute("oiio:ColorSpace", "Linear");
  for (const auto& [name, value] : image.metadata) spec.attribute(name, value);
  write_image(file, image, spec, temporary_folder);
}

void write_png(const fs::path& file, const Image& image, const fs::path& temporary_folder) {
  OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("png:compressionLevel", 6);
  write_image(file, image, spec, temporary_folder);
}

Image read_exr_header(const fs::path& file) {
  const OIIO::ImageSpec spec = open_exr(file)->spec();
  return {spec.width, spec.height, {}, text_attributes(spec)};
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

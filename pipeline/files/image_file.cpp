#include "pipeline/files/image_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <fstream>

#include "pipeline/files/temporary_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

constexpr int kMaxSide = 65536;
constexpr std::int64_t kMostChannelValues = std::int64_t{1} << 31;

[[noreturn]] void refuse(const std::string& what, const fs::path& file) {
  throw Error(ExitCode::bad_data, what, file.string(), "render it again");
}

std::ofstream create(const TemporaryFile& temporary) {
  std::ofstream stream(temporary.path(), std::ios::binary);
  if (!stream)
    throw Error(ExitCode::cannot_create, "cannot create the image", temporary.target().string(),
                "check that its folder is writable");
  return stream;
}

[[noreturn]] void cannot_write(const std::string& why, const TemporaryFile& temporary) {
  throw Error(ExitCode::io_error, "cannot write the image: " + why, temporary.target().string(),
              "check the space left on the disk");
}

bool begins_as_exr(const fs::path& file) {
  std::error_code fault;
  if (!fs::is_regular_file(file, fault)) return false;
  std::array<char, 4> magic{};
  std::ifstream(file, std::ios::binary).read(magic.data(), magic.size());
  return magic == std::array<char, 4>{0x76, 0x2f, 0x31, 0x01};
}

/// The size of what `header` describes and its texts, without pixels.
Image described(const Imf::Header& header, const fs::path& file) {
  const Imath::Box2i window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide || width * height * 3 > kMostChannelValues)
    refuse("an EXR of unexpected size", file);
  Image image{int(width), int(height), {}, {}};
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute()))
      image.metadata[attribute.name()] = text->value();
  return image;
}

/// Opens an EXR and does `read` with it.
template <class Read>
Image with_exr(const fs::path& file, Read read) {
  if (std::error_code fault; !fs::exists(file, fault))
    throw Error(ExitCode::missing_input, "missing image", file.string(), "check the path");
  if (!begins_as_exr(file)) throw Error(ExitCode::bad_data, "not an EXR", file.string(), "render it again");
  try {
    Imf::InputFile input(file.c_str(), 0);
    return read(input);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& fault) {
    refuse(std::string("a damaged EXR: ") + fault.what(), file);
  }
}

}  // namespace

void write_exr(const fs::path& file, const Image& image, const fs::path& temporary_folder) {
  TemporaryFile temporary(file, temporary_folder);
  std::ofstream stream = create(temporary);
  try {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [name, value] : image.metadata) header.insert(name.c_str(), Imf::StringAttribute(value));
    std::vector<Imath::half> halves(image.pixels.size() * 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      for (int k = 0; k < 3; ++k) halves[3 * i + k] = image.pixels[i][k];
    Imf::FrameBuffer buffer;
    const std::size_t pixel = 3 * sizeof(Imath::half);
    for (int k = 0; k < 3; ++k) {
      const std::string name(1, "RGB"[k]);
      header.channels().insert(name, Imf::Channel(Imf::HALF));
      buffer.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(halves.data() + k), pixel,
                                     pixel * std::size_t(image.width)));
    }
    Imf::StdOFStream target(stream, temporary.path().c_str());
    Imf::OutputFile output(target, header, 0);
    output.setFrameBuffer(buffer);
    output.writePixels(image.height);
  } catch (const std::exception& fault) {
    cannot_write(fault.what(), temporary);
  }
  stream.close();
  if (!stream) cannot_write("it does not fit", temporary);
  temporary.commit();
}

void write_png(const fs::path& file, const Image& image, const fs::path& temporary_folder) {
  TemporaryFile temporary(file, temporary_folder);
  create(temporary);
  std::vector<png_byte> bytes;
  bytes.reserve(image.pixels.size() * 3);
  for (const Color& c : image.pixels)
    for (int k = 0; k < 3; ++k) bytes.push_back(png_byte(std::lround(std::clamp(c[k], 0.0f, 1.0f) * 255.0f)));
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = png_uint_32(image.width);
  png.height = png_uint_32(image.height);
  png.format = PNG_FORMAT_RGB;
  if (!png_image_write_to_file(&png, temporary.path().c_str(), 0, bytes.data(), 0, nullptr))
    cannot_write(png.message, temporary);
  temporary.commit();
}

Image read_exr_header(const fs::path& file) {
  return with_exr(file, [&](Imf::InputFile& input) { return described(input.header(), file); });
}

Image read_exr(const fs::path& file) {
  return with_exr(file, [&](Imf::InputFile& input) {
    Image image = described(input.header(), file);
    const Imath::V2i first = input.header().dataWindow().min;
    image.pixels.resize(std::size_t(image.width) * image.height);
    Imf::FrameBuffer buffer;
    for (int k = 0; k < 3; ++k) {
      const std::string name(1, "RGB"[k]);
      const Imf::Channel* channel = input.header().channels().findChannel(name);
      if (!channel || channel->xSampling != 1 || channel->ySampling != 1)
        throw Error(ExitCode::bad_data, "an EXR without channels R, G and B", file.string(), "name another image");
      buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, &image.pixels[0][k], first, image.width, image.height,
                                           sizeof(Color), sizeof(Color) * std::size_t(image.width)));
    }
    input.setFrameBuffer(buffer);
    input.readPixels(first.y, first.y + image.height - 1);
    return image;
  });
}

}  // namespace patchlight

#include "pipeline/image/image_file.h"

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
#include <type_traits>

#include "pipeline/model/error.h"
#include "pipeline/system/temporary_file.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

constexpr int kMaxSide = 65536;
constexpr std::int64_t kMaxChannelValues = std::int64_t{1} << 31;

static_assert(Imf::DWAB_COMPRESSION + 1 == kExrCompressions.size());

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

bool has_exr_magic(const fs::path& file) {
  std::error_code fault;
  if (!fs::is_regular_file(file, fault)) return false;
  std::array<char, 4> magic{};
  std::ifstream(file, std::ios::binary).read(magic.data(), magic.size());
  return magic == std::array<char, 4>{0x76, 0x2f, 0x31, 0x01};
}

/// An image of the header's size and text attributes, without pixels.
Image image_of_header(const Imf::Header& header, const fs::path& file) {
  const Imath::Box2i window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide || width * height * 3 > kMaxChannelValues)
    refuse("an EXR of unexpected size", file);
  Image image{int(width), int(height), {}, {}};
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute()))
      image.metadata[attribute.name()] = text->value();
  return image;
}

/// Opens an EXR and calls `read` with it. Throws: Error (missing_input, bad_data).
template <class Read>
Image with_exr(const fs::path& file, Read read) {
  if (std::error_code fault; !fs::exists(file, fault))
    throw Error(ExitCode::missing_input, "missing image", file.string(), "check the path");
  if (!has_exr_magic(file)) throw Error(ExitCode::bad_data, "not an EXR", file.string(), "render it again");
  try {
    Imf::InputFile input(file.c_str(), 0);
    return read(input);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& fault) {
    refuse(std::string("a damaged EXR: ") + fault.what(), file);
  }
}

/// The frame buffer of an EXR to write. Owns values that are converted to half.
class Channels {
 public:
  Channels(Imf::Header& header, const Image& image, bool as_half) : header_(header), image_(image), as_half_(as_half) {}

  /// `names`: channel names of a pixel's values, in order. `values` must outlive the buffer.
  template <typename Value>
  void add(const std::vector<std::string>& names, const std::vector<Value>& values, bool color) {
    if (values.size() != std::size_t(image_.width) * std::size_t(image_.height))
      throw std::logic_error("a layer differs in size from its image");
    if constexpr (std::is_same_v<Value, std::uint32_t>) {
      insert(names, Imf::UINT, values.data(), sizeof(std::uint32_t));
    } else if (!color || !as_half_) {
      insert(names, Imf::FLOAT, values.data(), sizeof(float));
    } else {
      const auto* floats = reinterpret_cast<const float*>(values.data());
      halves_.emplace_back(floats, floats + values.size() * names.size());
      insert(names, Imf::HALF, halves_.back().data(), sizeof(Imath::half));
    }
  }

  const Imf::FrameBuffer& buffer() const { return buffer_; }

 private:
  void insert(const std::vector<std::string>& names, Imf::PixelType type, const void* values, std::size_t size) {
    const std::size_t pixel = names.size() * size;
    for (std::size_t k = 0; k < names.size(); ++k) {
      header_.channels().insert(names[k], Imf::Channel(type));
      char* first = const_cast<char*>(static_cast<const char*>(values)) + k * size;
      buffer_.insert(names[k], Imf::Slice(type, first, pixel, pixel * std::size_t(image_.width)));
    }
  }

  Imf::Header& header_;
  const Image& image_;
  const bool as_half_;
  Imf::FrameBuffer buffer_;
  std::vector<std::vector<Imath::half>> halves_;
};

std::vector<std::string> channel_names(const std::string& layer, const std::string& letters) {
  std::vector<std::string> names;
  for (const char letter : letters) names.push_back((layer.empty() ? "" : layer + ".") + letter);
  return names;
}

/// The layers among a file's channels, of the kinds that write_exr() writes; without values.
std::vector<ImageLayer> layers_of(const Imf::ChannelList& channels) {
  std::map<std::string, std::string> letters;
  std::map<std::string, bool> is_integer;
  for (auto c = channels.begin(); c != channels.end(); ++c) {
    const std::string name = c.name();
    const std::size_t dot = name.rfind('.');
    if (dot == std::string::npos || dot + 2 != name.size() || c.channel().xSampling != 1 || c.channel().ySampling != 1)
      continue;
    letters[name.substr(0, dot)] += name.back();
    is_integer[name.substr(0, dot)] = c.channel().type == Imf::UINT;
  }
  std::vector<ImageLayer> layers;
  for (const auto& [name, sorted_letters] : letters) {
    if (sorted_letters == "BGR") layers.push_back({name, "RGB", std::vector<Color>()});
    if (sorted_letters == "XYZ") layers.push_back({name, "XYZ", std::vector<Color>()});
    if (sorted_letters.size() != 1) continue;
    if (is_integer[name])
      layers.push_back({name, sorted_letters, std::vector<std::uint32_t>()});
    else
      layers.push_back({name, sorted_letters, std::vector<float>()});
  }
  return layers;
}

/// Allocates a layer's values and adds them to the frame buffer.
template <typename Value>
void prepare(const Imf::InputFile& input, const ImageLayer& layer, std::vector<Value>& values,
             Imf::FrameBuffer& buffer) {
  const Imath::Box2i window = input.header().dataWindow();
  const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
  values.resize(std::size_t(width) * std::size_t(height));
  const auto type = std::is_same_v<Value, std::uint32_t> ? Imf::UINT : Imf::FLOAT;
  for (std::size_t k = 0; k < layer.channels.size(); ++k)
    buffer.insert(channel_names(layer.name, layer.channels)[k],
                  Imf::Slice::Make(type, reinterpret_cast<char*>(values.data()) + k * sizeof(float), window.min, width,
                                   height, sizeof(Value), sizeof(Value) * std::size_t(width)));
}

Image read_pixels(const fs::path& file, bool with_layers) {
  return with_exr(file, [&](Imf::InputFile& input) {
    Image image = image_of_header(input.header(), file);
    const Imath::V2i first = input.header().dataWindow().min;
    image.pixels.resize(std::size_t(image.width) * image.height);
    Imf::FrameBuffer buffer;
    std::int64_t channels = 0;
    for (auto c = input.header().channels().begin(); c != input.header().channels().end(); ++c) ++channels;
    if (with_layers && channels * image.width * image.height > kMaxChannelValues)
      refuse("an EXR of unexpected size", file);
    for (int k = 0; k < 3; ++k) {
      const std::string name(1, "RGB"[k]);
      const Imf::Channel* channel = input.header().channels().findChannel(name);
      if (!channel || channel->xSampling != 1 || channel->ySampling != 1)
        throw Error(ExitCode::bad_data, "an EXR without channels R, G and B", file.string(), "name another image");
      buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, &image.pixels[0][k], first, image.width, image.height,
                                           sizeof(Color), sizeof(Color) * std::size_t(image.width)));
    }
    if (with_layers) image.layers = layers_of(input.header().channels());
    for (ImageLayer& layer : image.layers)
      std::visit([&](auto& values) { prepare(input, layer, values, buffer); }, layer.values);
    input.setFrameBuffer(buffer);
    input.readPixels(first.y, first.y + image.height - 1);
    return image;
  });
}

}  // namespace

void write_exr(const fs::path& file, const Image& image, const fs::path& temporary_folder, const ExrFormat& format) {
  TemporaryFile temporary(file, temporary_folder);
  std::ofstream stream = create(temporary);
  try {
    Imf::Header header(image.width, image.height);
    for (std::size_t k = 0; k < kExrCompressions.size(); ++k)
      if (format.compression == kExrCompressions[k]) header.compression() = Imf::Compression(k);
    for (const auto& [name, value] : image.metadata) header.insert(name.c_str(), Imf::StringAttribute(value));
    Channels channels(header, image, format.pixel_type == "half");
    channels.add(channel_names("", "RGB"), image.pixels, true);
    for (const ImageLayer& layer : image.layers)
      std::visit(
          [&](const auto& values) {
            channels.add(channel_names(layer.name, layer.channels), values, layer.channels == "RGB");
          },
          layer.values);
    Imf::StdOFStream target(stream, temporary.path().c_str());
    Imf::OutputFile output(target, header, 0);
    output.setFrameBuffer(channels.buffer());
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
  png.flags = PNG_IMAGE_FLAG_FAST;  // five times as fast; files are 1.5 times as large
  if (!png_image_write_to_file(&png, temporary.path().c_str(), 0, bytes.data(), 0, nullptr))
    cannot_write(png.message, temporary);
  temporary.commit();
}

Image read_exr_header(const fs::path& file) {
  return with_exr(file, [&](Imf::InputFile& input) {
    Image image = image_of_header(input.header(), file);
    image.layers = layers_of(input.header().channels());
    return image;
  });
}

Image read_exr(const fs::path& file) {
  return read_pixels(file, false);
}

Image read_exr_layers(const fs::path& file) {
  return read_pixels(file, true);
}

}  // namespace patchlight

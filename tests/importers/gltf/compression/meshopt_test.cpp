// KHR_meshopt_compression: what it has beyond EXT_meshopt_compression.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "importers/gltf/model/mesh_decoder.h"
#include "tests/expect_error.h"
#include "tests/importers/gltf_packer.h"

namespace patchlight::test {
namespace {

Bytes from_hex(const std::string& text) {
  Bytes bytes;
  for (std::size_t i = 0; i < text.size(); i += 2)
    bytes.push_back(static_cast<unsigned char>(std::stoi(text.substr(i, 2), nullptr, 16)));
  return bytes;
}

MeshoptView attributes(std::size_t count, std::size_t stride) {
  MeshoptView view;
  view.count = count;
  view.stride = stride;
  view.khr = true;
  return view;
}

/// 40 elements of 16 bytes, as numbers that the codecs of version 1 suit.
Bytes elements() {
  std::uint32_t random = 1;
  const auto next = [&] { return (random = random * 1664525u + 1013904223u) >> 24; };
  Bytes bytes;
  for (std::uint32_t i = 0; i < 40; ++i) {
    const std::uint32_t shifted = next() << 6, pair = (i * 37 & 0xffff) | (i * i * 411 & 0xffff) << 16;
    for (const std::uint32_t word : {pair, shifted, 7u, i % 2 | i * i % 5 << 8 | i / 4 % 3 * 20 << 16 | next() << 24})
      for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<unsigned char>(word >> shift));
  }
  return bytes;
}

/// elements() by the encoder of meshoptimizer 1.3, with deltas of bytes and shorts and rotated words.
const char* const kEncoded =
    "a1fbaeaad5004a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a0036a20e7a"
    "e652be2a96026eda46b21e8af662ce3aa6127eea56c22e9a0672de4ab6228efa66d23e00030910161c232930363d43495056"
    "5d636970767d838a90969da3aab0b7bdc3cad0d7dde3eaf0f700bd8dcac244d7abe072992533b4d6adbb36149715d288d1e9"
    "c3a727b63a97eaeec9fd8bdf10d18c152666666666666666666600002a026051260512605126051260512605126051260500"
    "00000000101128284f111128284f281100284f00acab602a6dd44ab06adb6ec8a7beda63dde48f86cc6b06994a6e690a2c8e"
    "68a43273d1d9f3afcb0000000000000000000f0000070000000000005e01220000";

TEST(Meshopt, Version1GivesTheElementsOfItsEncoder) {
  const Bytes stream = from_hex(kEncoded);
  EXPECT_EQ(decompress_meshopt(attributes(40, 16), stream, "here"), elements());
  // 300 equal elements, in two blocks without data.
  const Bytes equal = from_hex("a1aaaa" + std::string(38, '0') + "0909090900");
  EXPECT_EQ(decompress_meshopt(attributes(300, 4), equal, "here"), Bytes(1200, 9));
}

TEST(Meshopt, Version1DecodesTheExampleOfItsSpecification) {
  // Codes of four bits for 16 elements, then of one bit for the next 16. All are of the elements' first byte.
  const Bytes stream = from_hex("a1a807" + std::string("175ff0bc77a9210034b5") + "01800203" + std::string(48, '0'));
  const std::vector<int> differences{-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0,
                                     1,  0,  0,  0,  0,   0, 0,  0, 0,  0,  0, 0,  0, 0,  0, -2};
  Bytes expected;
  int value = 0;
  for (const int difference : differences) {
    value += difference;
    expected.insert(expected.end(), {static_cast<unsigned char>(value), 0, 0, 0});
  }
  EXPECT_EQ(decompress_meshopt(attributes(32, 4), stream, "here"), expected);
}

TEST(Meshopt, DamagedVersion1IsRefused) {
  const Bytes stream = from_hex(kEncoded);
  const auto expect_refused = [](const Bytes& bytes, std::size_t count = 40) {
    EXPECT_ERROR(decompress_meshopt(attributes(count, 16), bytes, "here"), ExitCode::bad_data, "damaged");
  };
  for (std::size_t size = 0; size < stream.size(); size += 9)
    expect_refused(Bytes(stream.begin(), stream.begin() + std::ptrdiff_t(size)));
  expect_refused(stream, 24);
  expect_refused(stream, 700);
  for (const int mode : {3, 16, 17}) {
    Bytes changed = stream;
    changed.back() = static_cast<unsigned char>(mode);
    expect_refused(changed);
  }
}

TEST(Meshopt, ColoursAreThoseOfTheEncoder) {
  const std::vector<double> colors{1, 0, 0, 1, 0, 1, 0, 0.5, 0.2, 0.4, 0.6, 0.8, 1, 1, 1, 0, 0, 0, 0, 1};
  struct Packed {
    std::size_t stride;
    int bits;
    const char* bytes;
  };
  for (const Packed& packed :
       {Packed{4, 8, "407fc1ff7f007fc066cd00e6ff000080000000ff"},
        Packed{4, 6, "101ff13f1f001f301af400393f0000200000003f"},
        Packed{8, 12, "0004ff0701fcff0fff070000ff07000c6606cdfc0000660eff0f000000000008000000000000ff0f"}}) {
    MeshoptView view = attributes(5, packed.stride);
    view.filter = MeshoptView::Filter::color;
    // All bytes as they are: control mode 3, and codes that differ from the byte before.
    const Bytes values = from_hex(packed.bytes);
    std::string stream = "a1" + std::string(packed.stride / 2, 'f');
    for (std::size_t k = 0; k < packed.stride; ++k)
      for (std::size_t i = 0; i < 5; ++i) {
        const int change = values[i * packed.stride + k] - (i > 0 ? values[(i - 1) * packed.stride + k] : 0);
        const auto wrapped = static_cast<std::int8_t>(change);
        stream += fmt::format("{:02x}", wrapped < 0 ? -2 * wrapped - 1 : 2 * wrapped);
      }
    const Bytes decoded = decompress_meshopt(view, from_hex(stream + std::string(48, '0')), "here");
    for (std::size_t i = 0; i < colors.size(); ++i) {
      const double value =
          packed.stride == 4 ? decoded.at(i) / 255.0 : (decoded.at(2 * i) + 256 * decoded.at(2 * i + 1)) / 65535.0;
      EXPECT_NEAR(value, colors[i], 1.01 / (1 << (packed.bits - 1))) << packed.bits << " bits, " << i;
    }
  }
}

/// A cube compressed by EXT_meshopt_compression.
GltfBuilder compressed_cube() {
  GltfBuilder gltf;
  const QuantizedPositions positions(cube());
  gltf.node(positions.with_transform({{"mesh", quantized_mesh(gltf, cube(), positions, true)}}));
  return gltf;
}

TEST(Meshopt, FilesOfEitherExtensionAreRead) {
  Importer importer;
  GltfBuilder gltf = compressed_cube();
  const PatchSet scene = importer.import(gltf);
  std::string text = gltf.json.dump();
  for (std::size_t at; (at = text.find("EXT_meshopt")) != std::string::npos;) text.replace(at, 3, "KHR");
  gltf.json = Json::parse(text);
  const PatchSet same = importer.import(gltf);
  ASSERT_EQ(same.primitives.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(same.primitives[i].corners, scene.primitives[i].corners);

  Json& extensions = gltf.json["bufferViews"][0]["extensions"];
  extensions["KHR_meshopt_compression"]["filter"] = "WAVELET";
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "unknown filter 'WAVELET'");
  extensions["KHR_meshopt_compression"].erase("filter");
  extensions["EXT_meshopt_compression"] = extensions["KHR_meshopt_compression"];
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "together");
}

TEST(Meshopt, ColoursAreOnlyOfTheKhrExtension) {
  Importer importer;
  GltfBuilder gltf = compressed_cube();
  gltf.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["filter"] = "COLOR";
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "unknown filter 'COLOR'");
}

}  // namespace
}  // namespace patchlight::test

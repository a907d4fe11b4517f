#include "pipeline/image/image_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

Image with_layers() {
  Image image{40, 30, {}, {{"Camera", "one"}}};
  std::vector<Color> light;
  std::vector<float> depth;
  std::vector<std::uint32_t> ids;
  for (int i = 0; i < 40 * 30; ++i) {
    image.pixels.emplace_back(0.1f * float(i), 1.0f, std::abs(std::sin(float(i))));
    light.emplace_back(1.0f / float(i + 1), 3.0f, 0.0f);
    depth.push_back(1e10f / float(i + 1));
    ids.push_back(0xffffffffu - std::uint32_t(i));
  }
  image.layers = {{"depth", "Z", depth}, {"direct", "RGB", light}, {"normal", "XYZ", light}, {"patch", "X", ids}};
  return image;
}

TEST(ImageFile, KeepsLayersByEveryLosslessCompression) {
  const test::TemporaryFolder folder;
  const Image image = with_layers();
  for (const char* compression : {"none", "rle", "zips", "zip", "piz"}) {
    write_exr(folder / "a.exr", image, {}, {"float", compression});
    const Image read = read_exr_layers(folder / "a.exr");
    EXPECT_EQ(read.pixels, image.pixels);
    EXPECT_EQ(read.metadata, image.metadata);
    ASSERT_EQ(read.layers.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(read.layers[k].name, image.layers[k].name);
      EXPECT_EQ(read.layers[k].channels, image.layers[k].channels);
      EXPECT_EQ(read.layers[k].values, image.layers[k].values) << compression << " " << image.layers[k].name;
    }
  }
}

TEST(ImageFile, StoresOnlyColorsAsHalfAndIntegersExactly) {
  const test::TemporaryFolder folder;
  const Image image = with_layers();
  for (const std::string compression : kExrCompressions) {
    write_exr(folder / "a.exr", image, {}, {"half", compression});
    const Image read = read_exr_layers(folder / "a.exr");
    EXPECT_EQ(read.layers[3].values, image.layers[3].values) << compression;
    const auto& depth = std::get<std::vector<float>>(read.layers[0].values);
    for (std::size_t i = 0; i < depth.size(); ++i) EXPECT_NEAR(depth[i] * float(i + 1), 1e10f, 1e6f) << compression;
    if (compression != "zip") continue;
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      EXPECT_NEAR(read.pixels[i].x, image.pixels[i].x, image.pixels[i].x * 0x1p-11);
    EXPECT_EQ(read.layers[2].values, image.layers[2].values) << "vectors are 32-bit floats";
  }
}

TEST(ImageFile, LayersDoNotChangeTheMainImage) {
  const test::TemporaryFolder folder;
  Image image = with_layers();
  write_exr(folder / "with.exr", image);
  const Image with = read_exr(folder / "with.exr");
  image.layers.clear();
  write_exr(folder / "without.exr", image);
  EXPECT_EQ(with.pixels, read_exr(folder / "without.exr").pixels);
  EXPECT_TRUE(with.layers.empty());
}

}  // namespace
}  // namespace patchlight

#include "pipeline/image/image_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/expect_error.h"

namespace patchlight {
namespace {

Image filled(int width, int height, const Color& color) {
  return {width, height, std::vector<Color>(std::size_t(width) * height, color), {}};
}

TEST(ImageError, IsZeroForTheReferenceItself) {
  const ImageError error = image_error(filled(16, 16, {3, 2, 1}), filled(16, 16, {3, 2, 1}));
  EXPECT_EQ(error.block, 0);
  EXPECT_EQ(error.blockrms, 0);
  EXPECT_EQ(error.relmse, 0);
  EXPECT_EQ(error.bias, 0);
}

TEST(ImageError, OfAUniformDifferenceIsRelativeToTheSoftenedReference) {
  const ImageError error = image_error(filled(16, 8, Color(1.5f)), filled(16, 8, Color(1.0f)));
  EXPECT_NEAR(error.block, 0.5 / 1.01, 1e-12);
  EXPECT_NEAR(error.blockrms, std::sqrt(0.25 / 1.01), 1e-12);
  EXPECT_NEAR(error.relmse, 0.25 / 1.01, 1e-12);
  EXPECT_NEAR(error.bias, 0.5, 1e-12);
}

TEST(ImageError, IsRelativeToEachBlocksReference) {
  // The left block, 1, is correct; the right block, 3, is 1 too dark; the mean is 2.
  Image reference = filled(16, 8, Color(1.0f)), frame = reference;
  for (int y = 0; y < 8; ++y)
    for (int x = 8; x < 16; ++x) {
      reference.pixels[std::size_t(16 * y + x)] = Color(3.0f);
      frame.pixels[std::size_t(16 * y + x)] = Color(2.0f);
    }
  const ImageError error = image_error(frame, reference);
  EXPECT_NEAR(error.block, 1 / 3.02 / 2, 1e-12);
  EXPECT_NEAR(error.blockrms, std::sqrt(1 / 9.04 / 2), 1e-12);
  EXPECT_NEAR(error.relmse, 1 / 9.04 / 2, 1e-12);
  EXPECT_NEAR(error.bias, 0, 1e-12);  // only pixels below 2.7
}

TEST(ImageError, AveragesNoiseInBlocksButNotInPixels) {
  Image frame = filled(8, 8, Color(1.0f));
  for (std::size_t i = 0; i < 64; ++i) frame.pixels[i] = Color(i % 2 == 0 ? 0.5f : 1.5f);
  const ImageError error = image_error(frame, filled(8, 8, Color(1.0f)));
  EXPECT_EQ(error.block, 0);
  EXPECT_NEAR(error.relmse, 0.25 / 1.01, 1e-12);
}

TEST(ImageError, RelmseIgnoresTheWorstThousandth) {
  Image frame = filled(40, 50, Color(1.0f));
  frame.pixels[7] = frame.pixels[8] = Color(1000.0f);
  EXPECT_EQ(image_error(frame, filled(40, 50, Color(1.0f))).relmse, 0);
}

TEST(ImageError, ScalesTheLargerImageDown) {
  Image large = filled(32, 16, Color(1.0f));
  for (std::size_t i = 0; i < large.pixels.size(); i += 2) large.pixels[i] = Color(3.0f);
  EXPECT_EQ(image_error(filled(16, 8, Color(2.0f)), large).block, 0);
  EXPECT_EQ(image_error(large, filled(16, 8, Color(2.0f))).block, 0);
  EXPECT_ERROR(image_error(filled(12, 12, Color(1.0f)), large), ExitCode::bad_data, "trace.resolution");
  EXPECT_ERROR(image_error(filled(8, 8, Color(1.0f)), large), ExitCode::bad_data, "trace.resolution");
}

TEST(ImageError, CountsNonFiniteValuesAsBlack) {
  Image frame = filled(8, 8, Color(1.0f));
  frame.pixels[0] = Color(std::numeric_limits<float>::quiet_NaN());
  EXPECT_NEAR(image_error(frame, filled(8, 8, Color(1.0f))).block, 1.0 / 64 / 1.01, 1e-9);
}

TEST(ImageError, IsZeroForAChannelThatIsBlackInBoth) {
  EXPECT_EQ(image_error(filled(8, 8, {1, 1, 0}), filled(8, 8, {1, 1, 0})).relmse, 0);
}

}  // namespace
}  // namespace patchlight

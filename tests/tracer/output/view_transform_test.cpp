#include "tracer/output/view_transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tests/expect_error.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

Color shown(const std::string& view, const Color& color, double exposure = 0) {
  return ViewTransform(view, exposure)(Image{1, 1, {color}, {}}).pixels[0];
}

TEST(ViewTransform, SrgbEncodesAndClamps) {
  EXPECT_NEAR(shown("sRGB", Color(0.18f)).x, 0.46136, 1e-4);
  EXPECT_NEAR(shown("sRGB", Color(7.0f)).x, 1.0f, 1e-6);
}

TEST(ViewTransform, AcesKeepsHighlightsDistinct) {
  EXPECT_LT(shown("ACES", Color(1.0f)).x, shown("ACES", Color(4.0f)).x);
  EXPECT_LT(shown("ACES", Color(4.0f)).x, 1.0f);
}

TEST(ViewTransform, RawIsLinear) {
  EXPECT_NEAR(shown("Raw", Color(0.18f)).x, 0.18, 1e-6);
}

TEST(ViewTransform, ExposureIsInStops) {
  EXPECT_NEAR(shown("Raw", Color(0.1f), 2).x, 0.4, 1e-6);
}

TEST(ViewTransform, ShowsOnlyFiniteValues) {
  for (const char* view : {"sRGB", "ACES", "Raw"})
    for (const float x : {NAN, INFINITY, -INFINITY, -1.0f, 1e38f}) {
      const Color c = shown(view, Color(x, 0.5f, x));
      for (int k = 0; k < 3; ++k) EXPECT_TRUE(c[k] >= 0 && c[k] <= 1) << view << " " << x;
    }
}

TEST(ViewTransform, NamesTheAvailableViews) {
  EXPECT_ERROR(ViewTransform("Filmic", 0), ExitCode::bad_config, "sRGB, ACES, Raw");
}

TEST(ViewTransform, UsesTheConfigInOcio) {
  const test::TemporaryFolder folder;
  const auto config = folder.write("config.ocio",
                                   "ocio_profile_version: 2\nroles: {default: lin, scene_linear: lin}\n"
                                   "file_rules: [!<Rule> {name: Default, colorspace: default}]\n"
                                   "displays: {d: [!<View> {name: mine, colorspace: lin}]}\n"
                                   "colorspaces: [!<ColorSpace> {name: lin}]\n");
  setenv("OCIO", config.c_str(), 1);
  EXPECT_NEAR(shown("mine", Color(0.25f)).x, 0.25, 1e-6);
  EXPECT_ERROR(ViewTransform("sRGB", 0), ExitCode::bad_config, "mine");
  setenv("OCIO", (folder / "none.ocio").c_str(), 1);
  EXPECT_ERROR(ViewTransform("sRGB", 0), ExitCode::missing_input, "none.ocio");
  setenv("OCIO", folder.write("broken.ocio", "][").c_str(), 1);
  EXPECT_ERROR(ViewTransform("sRGB", 0), ExitCode::bad_data, "broken.ocio");
  unsetenv("OCIO");
}

}  // namespace
}  // namespace patchlight

#include "tracer/output/view_transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tests/expect_error.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

Color shown(const PictureConfig& picture, const Color& color) {
  return ViewTransform(picture)(Image{1, 1, {color}, {}}).pixels[0];
}

Color shown(const std::string& view, const Color& color, double exposure = 0) {
  return shown(PictureConfig{.ocio = {}, .view = view, .look = {}, .exposure = exposure, .gamma = 1}, color);
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
  EXPECT_ERROR(shown("Filmic", Color(1.0f)), ExitCode::bad_config, "sRGB, ACES, Raw");
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
  EXPECT_ERROR(shown("sRGB", Color(1.0f)), ExitCode::bad_config, "mine");
  setenv("OCIO", (folder / "none.ocio").c_str(), 1);
  EXPECT_ERROR(shown("sRGB", Color(1.0f)), ExitCode::missing_input, "none.ocio");
  setenv("OCIO", folder.write("broken.ocio", "][").c_str(), 1);
  EXPECT_ERROR(shown("sRGB", Color(1.0f)), ExitCode::bad_data, "broken.ocio");
  unsetenv("OCIO");
}

TEST(ViewTransform, AppliesALookBeforeTheViewAndGammaAfterIt) {
  const test::TemporaryFolder folder;
  PictureConfig picture;
  picture.ocio = folder.write(
      "config.ocio",
      "ocio_profile_version: 2\nroles: {default: lin, scene_linear: lin}\n"
      "file_rules: [!<Rule> {name: Default, colorspace: default}]\n"
      "displays: {d: [!<View> {name: half, colorspace: half}]}\n"
      "looks: [!<Look> {name: plus, process_space: lin, transform: !<MatrixTransform> {offset: [0.1, 0.1, 0.1, 0]}}]\n"
      "colorspaces:\n  - !<ColorSpace> {name: lin}\n"
      "  - !<ColorSpace> {name: half, from_scene_reference: !<MatrixTransform> "
      "{matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}}\n");
  picture.view = "half";
  EXPECT_NEAR(shown(picture, Color(0.4f)).x, 0.2, 1e-6);
  picture.look = "plus";
  EXPECT_NEAR(shown(picture, Color(0.4f)).x, 0.25, 1e-6);
  picture.gamma = 2;
  EXPECT_NEAR(shown(picture, Color(0.4f)).x, 0.5, 1e-6);
  picture.exposure = 1;
  EXPECT_NEAR(shown(picture, Color(0.4f)).x, std::sqrt(0.45), 1e-6);
  picture.look = "minus";
  EXPECT_ERROR(shown(picture, Color(1.0f)), ExitCode::bad_config, "unknown look `minus`");
  picture.ocio = folder / "none.ocio";
  EXPECT_ERROR(shown(picture, Color(1.0f)), ExitCode::missing_input, "trace.ocio");
}

}  // namespace
}  // namespace patchlight

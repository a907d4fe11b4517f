#include <gtest/gtest.h>

#include <cmath>

#include "tests/glass_scene.h"
#include "tests/tracer/solved_scene.h"

namespace patchlight {
namespace {

using test::add_glass;
using test::add_level;
using test::add_veil;
using test::fresnel;
using test::PatchScene;
using test::Solved;

double mean_of(const Image& image, int channel = 1) {
  double sum = 0;
  for (const Color& pixel : image.pixels) sum += double(pixel[channel]) / double(image.pixels.size());
  return sum;
}

/// A camera at height 3 that looks down at an angle of this cosine to the vertical.
void look_down(Solved& solved, double cosine = 1.0, double angle = 1e-3) {
  solved.camera.to_world.rotate(Vec3d(-std::asin(cosine), 0, 0));
  solved.camera.to_world[3][1] = 3;
  solved.camera.to_world[3][2] = 3 * std::sqrt(1 - cosine * cosine) / cosine;
  solved.camera.vertical = angle;
  solved.job.trace.samples = 256;
}

/// Glass that absorbs nothing does not show before what is equally bright all around.
TEST(GlassFrames, InAWhiteSkyAreWhite) {
  for (const bool solid : {false, true}) {
    PatchScene builder;
    const int glass = add_glass(builder.get(), solid);
    builder.sphere({0, 0, 0}, 1, 4, 8, {0.0f, 0.0f, 0, glass});
    builder.get().environment = test::white_sky();
    Solved solved(builder, 0.0f, 0.0f);
    look_down(solved, 1.0, 0.5);
    EXPECT_NEAR(mean_of(solved.render()), 1, 0.002) << solid;
  }
}

TEST(GlassFrames, ShowWhatFresnelLetsPass) {
  for (const double cosine : {0.95, 0.5, 0.25})
    for (const bool solid : {false, true}) {
      PatchScene builder;
      const int glass = add_glass(builder.get(), solid, 0.0f, 1.5f, solid ? Color(1.0f) : Color(0.5f, 1.0f, 1.0f));
      add_level(builder, 0, 99, true, {0.5f});
      add_level(builder, 0.2, 99, true, {0.0f, 0.0f, 0, glass});
      if (solid) add_level(builder, 0.1, 99, false, {0.0f, 0.0f, 0, glass});
      Solved solved(builder, float(kPi), float(kPi));  // the floor's radiance is 1
      look_down(solved, cosine);
      const double r = fresnel(1.5, cosine), passed = solid ? (1 - r) / (1 + r) : 1 - r;
      const Image image = solved.render();
      EXPECT_NEAR(mean_of(image), passed, 0.01) << solid << ' ' << cosine;
      EXPECT_NEAR(mean_of(image, 0), passed * (solid ? 1 : 0.5), 0.01);
    }
}

TEST(GlassFrames, BodiesAbsorbAlongTheirLength) {
  PatchScene builder;
  const int glass = add_glass(builder.get(), true, 0.0f, 1.5f, Color(1.0f));
  builder.get().materials[glass].transmission.absorption = {2.0f, 0.0f, 0.0f};
  add_level(builder, 0, 99, true, {0.5f});
  add_level(builder, 0.6, 99, true, {0.0f, 0.0f, 0, glass});
  add_level(builder, 0.1, 99, false, {0.0f, 0.0f, 0, glass});
  Solved solved(builder, float(kPi), float(kPi));
  look_down(solved);
  const double r = fresnel(1.5, 1), once = std::exp(-1.0);
  EXPECT_NEAR(mean_of(solved.render(), 0), (1 - r) * (1 - r) * once / (1 - r * r * once * once), 0.01);
}

TEST(GlassFrames, VeilsAddTheirPart) {
  PatchScene builder;
  const int veil = add_veil(builder.get(), 0.3f);
  add_level(builder, 0, 99, true, {0.5f});
  builder.get().primitives[add_level(builder, 0.2, 99, true, {0.8f, 0.0f, 0, veil})].mask = 0;
  Solved solved(builder, float(kPi), float(kPi));
  look_down(solved);
  EXPECT_NEAR(mean_of(solved.render()), 0.7 * 1.0 + 0.3 * 1.6, 0.01);
}

/// Shadow rays through a sheet of red glass, to a lamp and to a sun.
TEST(GlassFrames, LampsShineThroughGlass) {
  const auto frame = [](bool with_glass) {
    PatchScene builder;
    const int red = add_glass(builder.get(), false, 0.0f, 1.5f, {0.8f, 0.2f, 0.0f});
    add_level(builder, 0, 0.2, true, {0.5f});
    builder.get().primitives.back().light_group = -1;
    add_level(builder, 4, 0.2, false, {0.0f, 50.0f});
    if (with_glass) add_level(builder, 3.5, 9, true, {0.0f, 0.0f, 0, red});
    for (std::size_t i = 2; i < builder.get().primitives.size(); ++i) builder.get().primitives[i].light_group = -1;
    Solved solved(builder, 0.0f, 0.0f);
    solved.job.trace.quality = "direct";
    look_down(solved, 1.0, 0.02);
    return solved.render();
  };
  const Image open = frame(false), glass = frame(true);
  ASSERT_GT(mean_of(open), 0.01);
  EXPECT_NEAR(mean_of(glass, 0) / mean_of(open, 0), 0.8 * 0.96, 0.01);
  EXPECT_NEAR(mean_of(glass, 1) / mean_of(open, 1), 0.2 * 0.96, 0.01);
}

TEST(GlassFrames, RoughSheetsBlurWhatIsBehind) {
  PatchScene builder;  // a bright and a dark half of a floor, behind glass
  const int glass = add_glass(builder.get(), false, 0.6f);
  builder.quad({{{-9, 0, 9}, {0, 0, 9}, {0, 0, -9}, {-9, 0, -9}}}, 1, 1, {0.9f});
  builder.quad({{{0, 0, 9}, {9, 0, 9}, {9, 0, -9}, {0, 0, -9}}}, 1, 1, {0.0f});
  add_level(builder, 1.0, 9, true, {0.0f, 0.0f, 0, glass});
  Solved solved(builder, float(kPi), 0.0f);
  look_down(solved, 1.0, 0.2);
  const Image image = solved.render();
  const double left = double(image.pixels[8 * 4].y), right = double(image.pixels[8 * 4 + 7].y);
  EXPECT_GT(right, 0.2 * left) << "a clear sheet would show the edge";
  EXPECT_NEAR(mean_of(image), 0.45 * 0.96, 0.03);
}

}  // namespace
}  // namespace patchlight

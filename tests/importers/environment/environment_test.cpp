#include "importers/environment/environment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/optics/lights/sky.h"
#include "tests/expect_error.h"
#include "tests/images.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

/// Writes an equirectangular image of `color(column, row)`.
template <class ColorOf>
std::filesystem::path write_sky(const std::filesystem::path& file, int width, int height, ColorOf color,
                                bool tiles = false) {
  Pixels pixels{width, height, 3};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Color c = color(x, y);
      pixels.values.insert(pixels.values.end(), {c.x, c.y, c.z});
    }
  write_image(file, pixels, PixelType::floating, tiles ? 16 : 0);
  return file;
}

PatchSet imported(Importer& importer) {
  GltfBuilder gltf = single_mesh(grid(1));
  return importer.import(gltf);
}

/// Irradiance of a surface with this normal from the environment's cells and suns.
Vec3d irradiance(const PatchSet& scene, const Vec3f& normal) {
  Vec3d sum(0.0);
  const Environment& sky = *scene.environment;
  constexpr int kSide = 240;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < 2 * kSide; ++i) {  // of equal solid angles
      const double y = 1 - 2 * (j + 0.5) / kSide, turn = kPi * (i + 0.5) / kSide, r = std::sqrt(1 - y * y);
      const Vec3f direction(float(r * std::cos(turn)), float(y), float(r * std::sin(turn)));
      const double cosine = std::max(0.0f, direction ^ normal);
      sum += Vec3d(sky.cells[sky_cell(sky, direction)]) * (cosine * 4 * kPi / (2 * kSide * kSide));
    }
  for (const Light& sun : scene.lights) sum += Vec3d(sun.strength) * std::max(0.0, -(sun.direction ^ Vec3d(normal)));
  return sum;
}

TEST(Environment, IsAbsentUnlessTheJobSetsOne) {
  Importer importer;
  const PatchSet scene = imported(importer);
  EXPECT_FALSE(scene.environment);
  EXPECT_TRUE(scene.light_groups.empty());
}

TEST(Environment, ColorIsUniform) {
  Importer importer;
  importer.job.environment.color = Color(1.0f, 2.0f, 3.0f);
  importer.job.environment.strength = 2;
  importer.job.environment.light_group = "sky";
  const PatchSet scene = imported(importer);
  ASSERT_TRUE(scene.environment);
  EXPECT_EQ(scene.environment->texels, std::vector{Color(2.0f, 4.0f, 6.0f)});
  EXPECT_EQ(scene.environment->cells, scene.environment->texels);
  EXPECT_EQ(scene.light_groups.at(scene.environment->light_group), "sky");
  importer.job.environment.strength = 0;
  EXPECT_FALSE(imported(importer).environment);
  EXPECT_THAT(importer.messages(), ::testing::HasSubstr("black"));
}

TEST(Environment, ImageGivesItsIrradiance) {
  // Brighter upwards, red on one side; in both formats, coarse and fine.
  for (const char* name : {"sky.hdr", "sky.exr"})
    for (const int width : {16, 256}) {
      Importer importer;
      importer.job.environment.image = write_sky(importer.folder / name, width, width / 2, [&](int x, int y) {
        return Color(x < width / 2 ? 1.0f : 0.25f, 2.0f * float(width / 2 - y) / float(width / 2), 0.5f);
      });
      const PatchSet scene = imported(importer);
      ASSERT_TRUE(scene.environment) << name;
      EXPECT_TRUE(scene.lights.empty());
      EXPECT_EQ(scene.environment->width, width);
      // The left half of the image lies towards -Z (Blender's +Y).
      EXPECT_NEAR(irradiance(scene, {0, 0, -1}).x, kPi, width == 16 ? 0.1 : 0.03) << name << width;
      EXPECT_NEAR(irradiance(scene, {0, 0, 1}).x, 0.25 * kPi, width == 16 ? 0.1 : 0.03);
      EXPECT_NEAR(irradiance(scene, {0, 1, 0}).z, 0.5 * kPi, 0.01);
      EXPECT_GT(irradiance(scene, {0, 1, 0}).y, 2 * irradiance(scene, {0, -1, 0}).y);
      EXPECT_EQ(scene.sources.at(1).path, name);
    }
}

TEST(Environment, SmallBrightSpotsBecomeSuns) {
  // A disk of 1 degree radius, 1e4 times as bright as the sky, at 45 degrees elevation in the middle of the image.
  Importer importer;
  constexpr int kWidth = 1024, kHeight = 512;
  const Vec3d to_sun = Vec3d(1, 1, 0).normalized();
  Environment grid;
  grid.width = kWidth;
  grid.height = kHeight;
  double expected = 0;
  const auto is_sun = [&](int x, int y) {
    return (direction_at(grid, x + 0.5, y + 0.5) ^ to_sun) > std::cos(kPi / 180);
  };
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      if (is_sun(x, y)) expected += 2 * kPi / kWidth * kPi / kHeight * std::sin(kPi * (y + 0.5) / kHeight) * 1e4;
  importer.job.environment.image = write_sky(importer.folder / "sky.exr", kWidth, kHeight, [&](int x, int y) {
    return is_sun(x, y) ? Color(1e4f, 0.5e4f, 0.0f) : Color(1.0f);
  });
  const PatchSet scene = imported(importer);
  ASSERT_EQ(scene.lights.size(), 1u);
  const Light& sun = scene.lights[0];
  EXPECT_EQ(sun.kind, Light::Kind::sun);
  EXPECT_EQ(sun.light_group, scene.environment->light_group);
  EXPECT_GT(-sun.direction ^ to_sun, std::cos(0.1 * kPi / 180));
  EXPECT_NEAR(sun.strength.x, expected, 0.01 * expected);
  EXPECT_NEAR(sun.outer, kPi / 180, 0.1 * kPi / 180);
  // Nothing is lost or counted twice.
  EXPECT_NEAR(irradiance(scene, Vec3f(to_sun)).x, expected + kPi, 0.01 * expected);
  EXPECT_NEAR(irradiance(scene, Vec3f(-to_sun)).x, kPi, 0.02);
  EXPECT_EQ(sky_radiance(*scene.environment, Vec3f(to_sun)).x, 1e4f);
  EXPECT_LT(clipped_radiance(*scene.environment, Vec3f(to_sun)).x, 100);

  importer.job.environment.rotation = 90;
  EXPECT_GT(-imported(importer).lights.at(0).direction ^ Vec3d(0, 1, -1).normalized(), std::cos(0.1 * kPi / 180));
}

TEST(Environment, AllRadianceAboveTheClipBelongsToSuns) {
  // A disk of 1 degree radius and a single brighter texel of negligible power; with `many`, 40 more disks.
  Importer importer;
  constexpr int kWidth = 512, kHeight = 256;
  Environment grid;
  grid.width = kWidth;
  grid.height = kHeight;
  const auto is_disk = [&](int x, int y, double turn, double height) {
    const Vec3d to(std::cos(height) * std::cos(turn), std::sin(height), std::cos(height) * std::sin(turn));
    return (direction_at(grid, x + 0.5, y + 0.5) ^ to) > std::cos(kPi / 180);
  };
  for (const bool many : {false, true}) {
    importer.job.environment.image = write_sky(importer.folder / "sky.exr", kWidth, kHeight, [&](int x, int y) {
      if (x == 3 && y == 20) return Color(2e4f);
      if (is_disk(x, y, 0.5, 0.7)) return Color(1e4f);
      for (int k = 0; many && k < 40; ++k)
        if (is_disk(x, y, 0.6 + 0.14 * k, -0.3)) return Color(0.3e4f);
      return Color(1.0f);
    });
    const PatchSet scene = imported(importer);
    EXPECT_EQ(scene.lights.size(), 2u) << many;
    const Environment& sky = *scene.environment;
    ASSERT_GT(sky.clip, 0);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const Vec3d to = direction_at(sky, x + 0.5, y + 0.5);
        if (sky_radiance(sky, Vec3f(to)).x <= sky.clip) continue;
        double nearest = -1;
        for (const Light& sun : scene.lights) nearest = std::max(nearest, -sun.direction ^ to);
        ASSERT_GT(nearest, std::cos(4 * kPi / 180)) << x << " " << y;
      }
  }
}

TEST(Environment, TiledImagesReadLikeScanlines) {
  Importer importer;
  const auto color = [](int x, int y) { return Color(float(x) / 64, float(y) / 32, 1.0f); };
  importer.job.environment.image = write_sky(importer.folder / "rows.exr", 64, 32, color);
  const PatchSet rows = imported(importer);
  importer.job.environment.image = write_sky(importer.folder / "tiles.exr", 64, 32, color, true);
  EXPECT_EQ(imported(importer).environment->texels, rows.environment->texels);
}

TEST(Environment, LargeImagesAreReduced) {
  Importer importer;
  importer.job.environment.image =
      write_sky(importer.folder / "sky.exr", 4096, 8, [](int x, int) { return Color(float(x % 2)); });
  const PatchSet scene = imported(importer);
  EXPECT_EQ(scene.environment->width, 2048);
  EXPECT_EQ(scene.environment->height, 8);
  for (const Color& texel : scene.environment->texels) EXPECT_EQ(texel, Color(0.5f));
}

TEST(Environment, ImagesOfAnyAspectRatioAreReduced) {
  Importer importer;
  importer.job.environment.image =
      write_sky(importer.folder / "sky.exr", 1, 20000, [](int, int y) { return Color(float(y < 10000)); });
  const PatchSet scene = imported(importer);
  EXPECT_EQ(scene.environment->texels.size(), 1000u);
  EXPECT_NEAR(irradiance(scene, {0, 1, 0}).x, kPi, 0.02);
  EXPECT_NEAR(irradiance(scene, {0, -1, 0}).x, 0, 0.02);
}

TEST(Environment, SmallNegativeRadianceCountsAsNone) {
  Importer importer;
  float negative = -0.009f;  // of a mean of about 1
  const auto write = [&] {
    importer.job.environment.image = write_sky(importer.folder / "sky.exr", 32, 16, [&](int x, int y) {
      return x == 3 && y > 0 && y < 5 ? Color(1.0f, negative, 1.0f) : Color(1.0f);
    });
  };
  write();
  const PatchSet scene = imported(importer);
  EXPECT_EQ(scene.environment->texels.at(32 + 3), Color(1.0f, 0.0f, 1.0f));
  EXPECT_EQ(scene.environment->texels.at(32 + 4), Color(1.0f));
  EXPECT_THAT(importer.messages(), ::testing::HasSubstr("4 texels of the environment's image"));
  negative = -0.011f;
  write();
  EXPECT_ERROR(imported(importer), ExitCode::bad_data, "column 3, row 1; it must be at least -1% of the image's mean");
}

TEST(Environment, BadImagesAreRefused) {
  Importer importer;
  importer.job.environment.image = importer.folder / "none.hdr";
  EXPECT_ERROR(imported(importer), ExitCode::missing_input, "none.hdr");
  importer.job.environment.image = importer.folder.write("text.hdr", "not an image");
  EXPECT_ERROR(imported(importer), ExitCode::bad_data, "neither Radiance .hdr nor OpenEXR");
  importer.job.environment.image =
      importer.folder.write("cut.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n");
  EXPECT_ERROR(imported(importer), ExitCode::bad_data, "cut.hdr");
  importer.job.environment.image =
      importer.folder.write("huge.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 30000 +X 60000\n");
  EXPECT_ERROR(imported(importer), ExitCode::over_limit, "60000 x 30000");
  for (const float fault : {-1.0f, NAN}) {
    importer.job.environment.image = write_sky(importer.folder / "bad.exr", 4, 2,
                                               [&](int x, int y) { return Color(x == 3 && y == 1 ? fault : 1.0f); });
    EXPECT_ERROR(imported(importer), ExitCode::bad_data, "column 3, row 1");
  }
  importer.job.environment.image = write_sky(importer.folder / "good.exr", 4, 2, [](int, int) { return Color(1e30f); });
  importer.job.environment.strength = 1e30;
  EXPECT_ERROR(imported(importer), ExitCode::bad_data, "too strong");
}

}  // namespace
}  // namespace patchlight::test

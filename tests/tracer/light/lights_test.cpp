#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/tracer/solved_scene.h"

namespace patchlight {
namespace {

using test::light_at;
using test::PatchScene;
using test::Solved;

/// The scene in parallel projection from above, 4 m x 4 m around the origin: pixel columns run along x, rows along z.
Solved from_above(PatchScene& builder, const std::string& quality = "direct") {
  Solved solved(builder, 0.0f, 0.0f);
  Camera& camera = solved.camera;
  camera.projection = Camera::Projection::orthographic;
  camera.vertical = 2;
  camera.to_world.rotate(Vec3d(-kPi / 2, 0, 0));
  camera.to_world.x[3][1] = 10;
  solved.job.trace.quality = quality;
  solved.job.trace.resolution = {32, 32};
  solved.job.trace.samples = 16;
  return solved;
}

PatchScene floor_scene(float reflectance, int material = 0) {
  PatchScene builder;
  builder.get().materials.push_back({"satin", Color(0.8f), 0.4f});
  builder.get().materials.push_back({"mirror", Color(0.5f), 0.0f});
  builder.quad({{{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}}}, 4, 4, {reflectance, 0.0f, 0, material});
  return builder;
}

Vec3d position_of(std::size_t pixel) {
  return {-2 + (double(pixel % 32) + 0.5) / 8, 0, -2 + (double(pixel / 32) + 0.5) / 8};
}

const std::vector<Color>& layer(const Image& image, const std::string& name) {
  for (const ImageLayer& one : image.layers)
    if (one.name == name) return std::get<std::vector<Color>>(one.values);
  throw std::runtime_error("no layer " + name);
}

TEST(LightsInFrames, HaveTheirClosedFormAtThePixel) {
  PatchScene builder = floor_scene(0.5f);
  for (const auto kind : {Light::Kind::point, Light::Kind::spot, Light::Kind::sun})
    for (const char* quality : {"direct", "gather"}) {
      Solved solved = from_above(builder, quality);
      solved.job.trace.samples = 64;
      solved.job.trace.gather_rays = 1;
      solved.scene.lights = {light_at({0.3, 1.5, 0.2}, kind)};
      solved.scene.lights[0].inner = 0.2;
      solved.scene.lights[0].outer = kind == Light::Kind::spot ? 0.9 : 0.0;
      const DirectLight light(solved.scene.lights[0]);
      const Image image = solved.render();
      for (std::size_t p = 0; p < image.pixels.size(); ++p) {
        const double expected = 0.5 / kPi * 10 * light.form_factor(position_of(p), {0, 1, 0});
        ASSERT_NEAR(image.pixels[p].x, expected, 0.025 * expected + 1e-3) << int(kind) << quality << p;
        ASSERT_NEAR(image.pixels[p].y, image.pixels[p].x / 2, 1e-5);
      }
    }
}

TEST(LightsInFrames, CastSharpBlackShadows) {
  PatchScene builder = floor_scene(0.5f);
  builder.quad({{{-0.5, 1, -0.5}, {0.5, 1, -0.5}, {0.5, 1, 0.5}, {-0.5, 1, 0.5}}}, 1, 1, {0.0f});  // faces down
  Solved solved = from_above(builder);
  solved.job.trace.cull_backfaces = true;
  solved.scene.lights = {light_at({0, 2, 0}), light_at({9, 2, 0})};
  solved.scene.lights[1].strength = Color(0.0f, 0.0f, 40.0f);
  const Image image = solved.render();
  const DirectLight light(solved.scene.lights[0]);
  for (std::size_t p = 0; p < image.pixels.size(); ++p) {
    const Vec3d position = position_of(p);
    const double across = std::max(std::abs(position.x), std::abs(position.z));
    const double whole = 0.5 / kPi * 10 * light.form_factor(position, {0, 1, 0});
    if (across < 0.9) {
      EXPECT_EQ(image.pixels[p].x, 0) << p;
    } else if (across > 1.1) {
      EXPECT_NEAR(image.pixels[p].x, whole, 0.025 * whole) << p;
    }
  }
}

TEST(LightsInFrames, AreReflectedByRoughMetalsLikeSmallSpheres) {
  constexpr double kRadius = 0.02;
  PatchScene with_light = floor_scene(0.0f, 1), with_ball = floor_scene(0.0f, 1);
  const Vec3d at(0.3, 1.5, 0.2);
  with_ball.sphere(at, kRadius, 2, 4, {0.0f, float(10 / (kRadius * kRadius))});  // intensity: exitance r^2
  Solved solved = from_above(with_light), ball = from_above(with_ball);
  solved.scene.lights = {light_at(at)};
  const Image image = solved.render(), truth = ball.render();
  double sum = 0, expected = 0;
  for (std::size_t p = 0; p < image.pixels.size(); ++p) {
    const Vec3d offset = position_of(p) - Vec3d(at.x, 0, at.z);
    if (offset.length() < 0.2) continue;  // the ball itself
    sum += image.pixels[p].x;
    expected += truth.pixels[p].x;
  }
  EXPECT_GT(expected, 10);
  EXPECT_NEAR(sum / expected, 1.0, 0.02);
}

TEST(LightsInFrames, HavePenumbrasByTheirSize) {
  PatchScene builder = floor_scene(0.5f);
  builder.quad({{{-9, 1, -9}, {0, 1, -9}, {0, 1, 9}, {-9, 1, 9}}}, 1, 1, {0.0f});  // faces down, ends at x = 0
  const auto beyond_chord = [](double distance) {
    const double c = std::clamp(distance, -1.0, 1.0);
    return (std::acos(c) - c * std::sqrt(1 - c * c)) / kPi;
  };
  for (const auto kind : {Light::Kind::point, Light::Kind::sun}) {
    const double height = 100, size = kind == Light::Kind::sun ? 0.3 : 0.3 * height;
    Solved solved = from_above(builder);
    solved.job.trace.cull_backfaces = true;
    solved.scene.lights = {light_at({0, height, 0}, kind)};
    Light& light = solved.scene.lights[0];
    light.strength *= float(kind == Light::Kind::sun ? 1 : height * height);
    (kind == Light::Kind::sun ? light.outer : light.radius) = kind == Light::Kind::sun ? std::asin(size) : size;
    const DirectLight whole(light);
    const Image image = solved.render();
    double squares = 0;
    int partial = 0;
    for (std::size_t p = 0; p < image.pixels.size(); ++p) {
      const Vec3d at = position_of(p);
      const double to_edge = std::atan2(-at.x, 1), to_center = kind == Light::Kind::sun ? 0 : std::atan2(-at.x, height);
      const double visible = beyond_chord(std::sin(to_edge - to_center) / 0.3);
      const double expected = 0.5 / kPi * double(light.strength.x) * whole.form_factor(at, {0, 1, 0});
      const double error = image.pixels[p].x / expected - visible;
      // Three standard deviations of as many independent rays as a half hidden light takes: 8 for each sample.
      EXPECT_LT(std::abs(error), 3 * 0.5 / std::sqrt(8.0 * solved.job.trace.samples)) << int(kind) << " " << p;
      squares += error * error / double(image.pixels.size());
      partial += visible > 0.02 && visible < 0.98;
    }
    EXPECT_LT(std::sqrt(squares), 0.01) << int(kind);
    EXPECT_GE(partial, 4 * 32);
  }
}

TEST(LightsInFrames, WithARadiusAreReflectedByRoughMetalsLikeBalls) {
  constexpr double kRadius = 0.4;
  PatchScene with_light = floor_scene(0.0f, 1), with_ball = floor_scene(0.0f, 1);
  const Vec3d at(0.3, 1.5, 0.2);
  with_ball.sphere(at, kRadius, 2, 4, {0.0f, float(10 / (kRadius * kRadius))});
  Solved solved = from_above(with_light), ball = from_above(with_ball);
  solved.scene.lights = {light_at(at)};
  solved.scene.lights[0].radius = kRadius;
  solved.job.trace.samples = ball.job.trace.samples = 64;
  const Image image = solved.render(), truth = ball.render();
  double sum = 0, expected = 0;
  for (std::size_t p = 0; p < image.pixels.size(); ++p) {
    if ((position_of(p) - Vec3d(at.x, 0, at.z)).length() < kRadius + 0.1) continue;  // the ball itself
    sum += image.pixels[p].x;
    expected += truth.pixels[p].x;
  }
  EXPECT_NEAR(sum / expected, 1.0, 0.02);
}

TEST(LightsInFrames, AreInvisible) {
  PatchScene builder = floor_scene(0.0f, 2);
  Solved solved = from_above(builder);
  solved.scene.lights = {light_at({0, 5, 0}), light_at({0, 2, 0})};
  solved.scene.lights[1].radius = 0.5;
  for (const Color& pixel : solved.render().pixels) EXPECT_EQ(pixel, Color(0.0f));
}

TEST(LightsInFrames, AreSeparatedInLayersByGroup) {
  PatchScene builder = floor_scene(0.5f);
  builder.get().light_groups = {"a", "b"};
  Solved solved = from_above(builder);
  solved.scene.lights = {light_at({0.3, 1.5, 0.2}), light_at({-1, 1, 1}, Light::Kind::sun)};
  solved.scene.lights[1].light_group = 1;
  solved.job.trace.layers = {"direct", "indirect", "light_groups"};
  solved.job.lights["b"] = {3.0, Color(1.0f, 0.5f, 1.0f)};
  const Image image = solved.render();
  for (std::size_t p = 0; p < image.pixels.size(); ++p) {
    const Color sum = layer(image, "Combined_a")[p] + layer(image, "Combined_b")[p] * Color(3.0f, 1.5f, 3.0f);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(image.pixels[p][k], sum[k], 1e-5f * (1 + sum[k]));
    EXPECT_EQ(layer(image, "direct")[p], image.pixels[p]);
    EXPECT_NEAR(layer(image, "Combined_b")[p].x, 0.5 / kPi * 10, 1e-4);
  }
}

/// Blue around -Z, red around +Z.
Environment two_skies() {
  Environment sky;
  sky.width = 2;
  sky.texels = {Color(0.0f, 0.0f, 3.0f), Color(2.0f, 0.0f, 0.0f)};
  sky.rows = 1;
  sky.cells = {Color(1.0f, 0.0f, 1.5f)};
  return sky;
}

TEST(SkyInFrames, IsBehindAllSurfacesAndInMirrors) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(0.5f), 0.0f});
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 0, -1}, {-9, 0, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});  // below the horizon
  Solved solved(builder, 0.0f, 0.0f);
  solved.scene.environment = two_skies();
  solved.job.trace.samples = 1;
  solved.job.trace.layers = {"emission", "specular", "depth", "light_groups"};
  solved.job.lights["light"].scale = 2;
  const Image image = solved.render();
  const auto near = [](const Color& a, const Color& b) { return (Vec3f(a) - Vec3f(b)).length() < 0.2f; };
  for (std::size_t p = 0; p < 64; ++p) {
    EXPECT_EQ(layer(image, "emission")[p], p < 32 ? image.pixels[p] : Color(0.0f));
    EXPECT_TRUE(near(image.pixels[p], layer(image, "Combined_light")[p] * 2.0f));
    EXPECT_EQ(std::get<std::vector<float>>(image.layers[2].values)[p] > 1e9f, p < 32) << p;
    EXPECT_EQ(layer(image, "specular")[p], p < 32 ? Color(0.0f) : image.pixels[p]);
  }
  const auto blue = [&](std::size_t p) { return image.pixels[p].z > image.pixels[p].x; };
  EXPECT_NE(blue(4), blue(60)) << "the mirror reflects the sky behind the camera";
}

TEST(SkyInFrames, AFurnaceIsUniformInEveryQuality) {
  PatchScene builder;
  builder.sphere({0, 0, -3}, 1, 6, 8, {0.99999f});
  Solved solved(builder, float(kPi), 0.0f);
  Environment sky;
  sky.texels = sky.cells = {Color(1.0f)};
  solved.scene.environment = sky;
  solved.energy.groups[0].gathered_direct = solved.energy.groups[0].direct;
  for (const char* quality : {"patches", "direct", "gather"}) {
    solved.job.trace.quality = quality;
    for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, 1, 1e-3) << quality;
  }
}

TEST(SkyInFrames, RoughMetalsReflectAFurnace) {
  PatchScene builder = floor_scene(0.0f, 1);
  Solved solved = from_above(builder);
  Environment sky;
  sky.texels = sky.cells = {Color(1.0f)};
  solved.scene.environment = sky;
  for (const Color& pixel : solved.render().pixels) {
    EXPECT_LE(pixel.y, 0.8f + 1e-4f);
    EXPECT_GT(pixel.y, 0.75f);  // single scattering loses some energy
  }
}

}  // namespace
}  // namespace patchlight

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "tests/expect_error.h"
#include "tests/glass_scene.h"
#include "tests/tracer/solved_scene.h"
#include "tracer/output/layer_sums.h"

namespace patchlight {
namespace {

using test::PatchScene;
using test::Solved;

const std::vector<std::string> kAllLayers{"direct",       "indirect", "specular",    "metal",  "coat",
                                          "transmission", "emission", "albedo",      "normal", "depth",
                                          "position",     "patch",    "light_groups"};

/// A room with two lamps of two groups, a block that casts shadows, balls of rough metal and of glass, a partly
/// specular wall and a coated floor.
Solved lit_room() {
  PatchScene builder;
  builder.get().light_groups = {"sun", "lamp"};
  builder.get().materials.push_back({"half mirror", Color(0.5f, 0.4f, 0.3f), 0.0f});
  builder.get().materials.push_back({"satin", Color(0.3f, 0.5f, 0.5f), 0.4f});
  builder.room(1, 3, {0.5f, 0.0f});
  builder.get().primitives[4].material = 1;  // in front of the camera
  builder.get().materials.push_back({"varnish", Color(0.0f), 0.1f});
  builder.get().materials.back().coat = {Color(0.04f), 1.0f, 1.5f};
  builder.get().primitives[2].material = 3;  // the floor
  const int glass = test::add_glass(builder.get(), true);
  builder.sphere({-0.6, -0.6, 0.2}, 0.3, 4, 8, {0.0f, 0.0f, 0, glass});
  builder.quad({{{-0.6, 0.99, -0.4}, {0.0, 0.99, -0.4}, {0.0, 0.99, 0.2}, {-0.6, 0.99, 0.2}}}, 1, 1, {0.3f, 9.0f, 0});
  builder.quad({{{0.3, 0.9, -0.8}, {0.4, 0.9, -0.8}, {0.4, 0.9, -0.7}, {0.3, 0.9, -0.7}}}, 1, 1, {0.3f, 40.0f, 1});
  builder.quad({{{-0.4, 0, -0.5}, {-0.4, 0, 0.1}, {0.5, 0, 0.1}, {0.5, 0, -0.5}}}, 2, 2, {0.7f, 0.0f});
  builder.sphere({0.5, -0.6, 0.3}, 0.3, 4, 8, {0.4f, 0.0f, 0, 2});
  Solved solved(builder);
  for (std::size_t g = 0; g < 2; ++g) {
    EnergyField::Group& group = solved.energy.groups[g];
    for (std::size_t i = 0; i < solved.scene.patches.size(); ++i) {
      const Vec3d& at = solved.scene.patches[i].center;
      // Steep, so that linear extrapolation beyond the outermost centres becomes negative in places.
      group.indirect[i] = Color(float(std::max(0.0, g == 0 ? at.x : -at.x)), 0.3f, float(std::max(0.0, at.y)));
      group.direct[i] = Color(float(std::max(0.0, at.z)), 0.2f, 0.1f);
    }
    group.gathered_direct.assign(solved.scene.patches.size(), Color(g == 0 ? 0.1f : 0.0f));
  }
  solved.camera.to_world.translate(Vec3d(0, 0, 0.95));
  solved.camera.vertical = 2.0;
  solved.job.trace.resolution = {56, 40};
  solved.job.trace.quality = "direct";
  solved.job.trace.gather_rays = 4;
  return solved;
}

const std::vector<Color>& colors(const Image& image, const std::string& name) {
  for (const ImageLayer& layer : image.layers)
    if (layer.name == name) return std::get<std::vector<Color>>(layer.values);
  throw std::runtime_error("no layer " + name);
}

template <typename Value>
const std::vector<Value>& values(const Image& image, const std::string& name) {
  for (const ImageLayer& layer : image.layers)
    if (layer.name == name) return std::get<std::vector<Value>>(layer.values);
  throw std::runtime_error("no layer " + name);
}

/// Equal within float rounding of the sum.
void expect_equal(const Color& value, const Color& expected, std::size_t pixel) {
  for (int k = 0; k < 3; ++k) ASSERT_NEAR(value[k], expected[k], 2e-6 * (1 + expected[k])) << "pixel " << pixel;
}

TEST(Layers, DoNotChangeTheBeauty) {
  for (const char* quality : {"patches", "direct", "gather"}) {
    Solved solved = lit_room();
    solved.job.trace.quality = quality;
    const Image plain = solved.render();
    EXPECT_TRUE(plain.layers.empty());
    solved.job.trace.layers = kAllLayers;
    EXPECT_EQ(solved.render().pixels, plain.pixels) << quality;
  }
}

TEST(Layers, LightByTransportPathAddsUpToTheBeauty) {
  for (const char* quality : {"patches", "direct", "gather"}) {
    Solved solved = lit_room();
    solved.job.trace.quality = quality;
    solved.job.trace.layers = {"direct", "indirect", "specular", "emission", "metal", "coat", "transmission"};
    solved.job.lights["lamp"].scale = 0.3;
    const Image image = solved.render();
    std::vector<double> largest(7, 0.0);
    for (std::size_t p = 0; p < image.pixels.size(); ++p) {
      Color sum(0.0f), specular(0.0f);
      for (std::size_t k = 0; k < 7; ++k) {
        const Color& part = std::get<std::vector<Color>>(image.layers[k].values)[p];
        (k < 4 ? sum : specular) += part;
        largest[k] = std::max(largest[k], double(part.y));
      }
      expect_equal(sum, image.pixels[p], p);
      expect_equal(specular, std::get<std::vector<Color>>(image.layers[2].values)[p], p);
    }
    for (std::size_t k = 0; k < 7; ++k) EXPECT_GT(largest[k], 0.01) << quality << ": " << image.layers[k].name;
  }
}

TEST(Layers, AFrameUnderOtherSettingsIsTheSumOfItsLightGroups) {
  for (const char* quality : {"patches", "direct", "gather"}) {
    Solved solved = lit_room();
    solved.job.trace.quality = quality;
    solved.job.trace.layers = {"light_groups"};
    const Image layers = solved.render();
    const auto &sun = colors(layers, "Combined_sun"), &lamp = colors(layers, "Combined_lamp");
    for (std::size_t p = 0; p < sun.size(); ++p) expect_equal(sun[p] + lamp[p], layers.pixels[p], p);
    solved.job.trace.layers = {};
    for (const auto& [sun_scale, lamp_scale] : {std::pair(0.0, 5.0), {0.25, 0.0}, {3.0, 0.1}}) {
      solved.job.lights["sun"] = {sun_scale, Color(1.0f, 0.5f, 0.0f)};
      solved.job.lights["lamp"] = {lamp_scale, Color(0.2f, 1.0f, 1.0f)};
      const Image relit = solved.render();
      const Color a = Color(1.0f, 0.5f, 0.0f) * float(sun_scale), b = Color(0.2f, 1.0f, 1.0f) * float(lamp_scale);
      for (std::size_t p = 0; p < sun.size(); ++p) expect_equal(sun[p] * a + lamp[p] * b, relit.pixels[p], p);
    }
    // The layers themselves do not depend on the settings.
    solved.job.trace.layers = {"light_groups"};
    EXPECT_EQ(colors(solved.render(), "Combined_sun"), sun);
  }
}

TEST(Layers, HoldExactPatchDepthPositionAndNormal) {
  PatchScene builder;  // a slanted wall: its depth is 2 + x, at u = (x + 1) / 2
  builder.quad({{{-1, -2, -1}, {1, -2, -3}, {1, 2, -3}, {-1, 2, -1}}}, 4, 1, {0.5f});
  Solved solved(builder);
  solved.job.trace.samples = 1;
  solved.job.trace.layers = {"patch", "depth", "position", "normal", "albedo"};
  solved.camera.vertical = 0.6;
  const Image image = solved.render();
  const auto& patch = values<std::uint32_t>(image, "patch");
  const auto& depth = values<float>(image, "depth");
  const auto& position = colors(image, "position");
  std::set<std::uint32_t> patches_seen;
  for (std::size_t p = 0; p < image.pixels.size(); ++p) {
    EXPECT_EQ(patch[p], std::uint32_t((position[p].x + 1) / 2 * 4));
    EXPECT_NEAR(depth[p], 2 + position[p].x, 1e-5);
    EXPECT_NEAR(-position[p].z, depth[p], 1e-5);
    EXPECT_NEAR(position[p].y / depth[p], std::tan(0.3) * (1 - (float(p / 8) + 0.5f) / 4), std::tan(0.3) / 8);
    EXPECT_NEAR(colors(image, "normal")[p].x, std::sqrt(0.5), 1e-6);
    EXPECT_NEAR(colors(image, "normal")[p].z, std::sqrt(0.5), 1e-6);
    EXPECT_EQ(colors(image, "albedo")[p], Color(0.5f));
    patches_seen.insert(patch[p]);
  }
  EXPECT_GE(patches_seen.size(), 3u);
}

TEST(Layers, DoNotAverageDepthsOfTwoSurfaces) {
  PatchScene builder;
  builder.quad({{{-9, -9, -4}, {9, -9, -4}, {9, 9, -4}, {-9, 9, -4}}}, 1, 1, {0.5f});
  builder.quad({{{-9, -9, -1}, {0.1, -9, -1}, {0.1, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.5f});
  Solved solved(builder);
  solved.job.trace.layers = {"patch", "depth"};
  solved.camera.vertical = 1.0;
  const Image image = solved.render();
  for (std::size_t p = 0; p < image.pixels.size(); ++p) {
    const std::uint32_t at = values<std::uint32_t>(image, "patch")[p];
    EXPECT_FLOAT_EQ(values<float>(image, "depth")[p], at == 0 ? 4.0f : 1.0f);
    EXPECT_EQ(at, p % 8 < 5 ? 1u : 0u) << "the surface at the pixel's centre";
  }
}

TEST(Layers, OfAnEmptyViewHoldTheirDefaults) {
  PatchScene builder;
  builder.quad({{{-9, -9, 1}, {-9, 9, 1}, {9, 9, 1}, {9, -9, 1}}}, 1, 1, {0.5f, 1.0f});  // behind the camera
  Solved solved(builder);
  solved.job.trace.layers = kAllLayers;
  const Image image = solved.render();
  for (std::size_t p = 0; p < image.pixels.size(); ++p) {
    EXPECT_EQ(values<std::uint32_t>(image, "patch")[p], 0xffffffffu);
    EXPECT_EQ(values<float>(image, "depth")[p], 1e10f);
    for (const char* name : {"position", "normal", "albedo", "direct", "emission", "Combined_light"})
      EXPECT_EQ(colors(image, name)[p], Color(0.0f)) << name;
  }
}

TEST(Layers, RefuseALightGroupWithTooLongAName) {
  PatchScene builder;
  builder.get().light_groups = {std::string(300, 'x')};
  builder.room(1, 1, {});
  Solved solved(builder);
  solved.job.trace.layers = {"light_groups"};
  EXPECT_ERROR(solved.render(), ExitCode::bad_config, "too long");
}

TEST(Layers, OfAMirrorDescribeItAndSpecularHoldsItsReflection) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(0.5f), 0.0f});
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.quad({{{-9, -9, 1}, {-9, 9, 1}, {9, 9, 1}, {9, -9, 1}}}, 1, 1, {0.6f, 3.0f});
  Solved solved(builder);
  solved.job.trace.layers = kAllLayers;
  const Image image = solved.render();
  for (std::size_t p = 0; p < image.pixels.size(); ++p) {
    EXPECT_NEAR(colors(image, "specular")[p].y, 0.5 * (3 + 0.6 * 3) / kPi, 1e-5);
    EXPECT_EQ(colors(image, "emission")[p] + colors(image, "direct")[p] + colors(image, "indirect")[p], Color(0.0f));
    EXPECT_EQ(values<std::uint32_t>(image, "patch")[p], 0u);
    EXPECT_FLOAT_EQ(values<float>(image, "depth")[p], 1.0f);
  }
}

TEST(Layers, AlbedoTimesIrradianceIsReflectedLight) {
  PatchScene builder;
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.5f});
  builder.get().shaders = {{"wall", {"abs(sin(9*x))", "0.5", "0"}, {}}};
  builder.get().primitives[0].shader = 0;
  Solved solved(builder, 2.0f, 1.0f);
  solved.job.trace.layers = {"albedo", "direct", "indirect"};
  const Image image = solved.render();
  for (std::size_t p = 0; p < image.pixels.size(); ++p) {
    const Color albedo = colors(image, "albedo")[p];
    expect_equal(colors(image, "direct")[p], albedo * float(2 / kPi), p);
    expect_equal(colors(image, "indirect")[p], albedo * float(1 / kPi), p);
  }
}

TEST(Layers, AreTheSameBitsForAnyNumberOfThreads) {
  for (const char* quality : {"patches", "direct", "gather"}) {
    Solved solved = lit_room();
    solved.job.trace.quality = quality;
    solved.job.trace.layers = kAllLayers;
    std::vector<Image> images;
    for (const std::size_t threads : {1, 3}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      images.push_back(solved.render());
    }
    EXPECT_EQ(images[0].pixels, images[1].pixels);
    ASSERT_EQ(images[0].layers.size(), kAllLayers.size() + 1);
    for (std::size_t k = 0; k < images[0].layers.size(); ++k)
      EXPECT_EQ(images[0].layers[k].values, images[1].layers[k].values) << quality << images[0].layers[k].name;
  }
}

}  // namespace
}  // namespace patchlight

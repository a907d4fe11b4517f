#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/optics/surface/coat_albedo.h"
#include "tests/tracer/solved_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;
using test::Solved;

/// A coated wall, seen at an angle whose cosine is given, in a white sky of radiance 1.
Solved wall_in_the_sky(float reflectance, float roughness, double cosine) {
  PatchScene builder;
  builder.get().materials.push_back({"coated", Color(0.0f), roughness});
  builder.get().materials.back().coat = {Color(0.04f), 1.0f, 1.5f};
  builder.quad({{{-99, 0, 99}, {99, 0, 99}, {99, 0, -99}, {-99, 0, -99}}}, 1, 1, {reflectance, 0.0f, 0, 1});
  Environment sky;
  sky.texels.assign(1, Color(1.0f));
  sky.rows = 1;
  sky.cells.assign(1, Color(1.0f));
  builder.get().environment = sky;
  Solved solved(builder, float(kPi), 0.0f);
  solved.camera.to_world.rotate(Vec3d(-std::asin(cosine), 0, 0));
  solved.camera.to_world[3][1] = 1;
  solved.camera.vertical = 1e-3;
  solved.job.trace.samples = 256;
  return solved;
}

double mean_of(const Image& image) {
  double sum = 0;
  for (const Color& pixel : image.pixels) sum += double(pixel.y) / double(image.pixels.size());
  return sum;
}

TEST(Coats, InAWhiteSkyReturnTheirAlbedoAndWhatPassesThem) {
  for (const float roughness : {0.0f, 0.2f, 0.6f, 1.0f})
    for (const double cosine : {0.95, 0.5, 0.25})
      for (const float reflectance : {0.0f, 0.5f, 0.99999f}) {
        const Solved solved = wall_in_the_sky(reflectance, roughness, cosine);
        const CoatAlbedos albedos(solved.scene);
        const double albedo = double(albedos.at(specular_properties_at(solved.scene, 0, 0.5, 0.5), float(cosine)).y);
        const double expected = albedo + double(reflectance) * (1 - albedo);
        EXPECT_NEAR(mean_of(solved.render()), expected, 0.005 * std::max(expected, 0.2))
            << roughness << ' ' << cosine << ' ' << reflectance;
      }
}

TEST(ClearCoats, InAWhiteSkyReturnTheirAlbedoAndWhatIsBelow) {
  constexpr float kMetal = 0.3f, kDiffuse = 0.5f;
  for (const float roughness : {0.0f, 0.3f})
    for (const float of_metal : {0.0f, kMetal})
      for (const double cosine : {0.95, 0.25}) {
        Solved solved = wall_in_the_sky(kDiffuse, 0.0f, cosine);
        solved.scene.materials[1].clear_coat = {0.8f, roughness};
        solved.scene.materials[1].specular = Color(of_metal);
        const CoatAlbedos albedos(solved.scene);
        const SpecularProperties at = specular_properties_at(solved.scene, 0, 0.5, 0.5);
        const double clear = double(albedos.at(at.clear_layer(), float(cosine)).y);
        const double both = double(albedos.at(at, float(cosine)).y);
        const double expected = both + double(kDiffuse) * (1 - both) + double(of_metal) * (1 - clear);
        EXPECT_NEAR(mean_of(solved.render()), expected, 0.005 * expected)
            << roughness << ' ' << of_metal << ' ' << cosine;
      }
}

TEST(ClearCoats, ReflectLampsSharplyOverRoughMetal) {
  PatchScene builder;  // a lamp behind the camera, in a smooth clear coat before it
  builder.get().materials.push_back({"paint", Color(0.0f), 1.0f});
  builder.get().materials.back().clear_coat = {1.0f, 0.0f};
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.quad({{{-9, -9, 1}, {-9, 9, 1}, {9, 9, 1}, {9, -9, 1}}}, 1, 1, {0.0f, 3.0f});
  Solved solved(builder);
  solved.camera.vertical = 1e-3;
  EXPECT_NEAR(mean_of(solved.render()), 0.04 * 3 / kPi, 1e-5);
}

/// Few samples of a rough coat are enough under a sky that is bright in few places.
TEST(Coats, ThatAreRoughShowBrightPlacesWithoutDots) {
  Solved solved = wall_in_the_sky(0.5f, 0.8f, 0.8);
  Environment& sky = *solved.scene.environment;
  sky.width = 16;
  sky.height = 8;
  sky.texels.assign(128, Color(0.1f));
  for (int k = 16; k < 48; k += 4) sky.texels[k] = Color(40.0f);
  solved.energy.groups[0].direct[0] = Color(0.0f);
  solved.job.trace.samples = 4;
  const Image image = solved.render();
  const double mean = mean_of(image);
  double squares = 0;
  for (const Color& pixel : image.pixels) squares += std::pow(double(pixel.y) - mean, 2) / double(image.pixels.size());
  EXPECT_LT(std::sqrt(squares), mean / 2);
}

TEST(Coats, LayersAddUp) {
  Solved solved = wall_in_the_sky(0.5f, 0.3f, 0.4);
  solved.scene.materials[1].clear_coat = {0.5f, 0.0f};
  solved.job.trace.layers = {"direct", "indirect", "specular", "emission"};
  const Image image = solved.render();
  double specular = 0;
  for (std::size_t p = 0; p < image.pixels.size(); ++p) {
    float sum = 0;
    for (const ImageLayer& layer : image.layers) {
      const float value = std::get<std::vector<Color>>(layer.values)[p].y;
      sum += value;
      if (layer.name == "specular") specular += double(value) / double(image.pixels.size());
    }
    EXPECT_NEAR(sum, image.pixels[p].y, 1e-3);
  }
  EXPECT_GT(specular, 0.05);
}

TEST(Coats, ReflectLampsAsMirrorsDo) {
  PatchScene builder;  // a lamp behind the camera, in a smooth coat before it
  builder.get().materials.push_back({"coated", Color(0.0f), 0.0f});
  builder.get().materials.back().coat = {Color(0.04f), 1.0f, 1.5f};
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.quad({{{-9, -9, 1}, {-9, 9, 1}, {9, 9, 1}, {9, -9, 1}}}, 1, 1, {0.0f, 3.0f});
  Solved solved(builder);
  solved.camera.vertical = 1e-3;
  EXPECT_NEAR(mean_of(solved.render()), 0.04 * 3 / kPi, 1e-5);
}

}  // namespace
}  // namespace patchlight

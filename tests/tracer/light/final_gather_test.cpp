#include "tracer/light/final_gather.h"

#include <gtest/gtest.h>

#include "tests/tracer/solved_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;
using test::Solved;

Solved gathered(PatchScene& builder, float direct, float indirect) {
  Solved solved(builder, direct, indirect);
  solved.job.trace.quality = "gather";
  solved.job.trace.gather_rays = 8;
  solved.job.trace.layers = {"direct", "indirect", "specular", "emission"};
  return solved;
}

const std::vector<Color>& colors(const Image& image, std::size_t layer) {
  return std::get<std::vector<Color>>(image.layers[layer].values);
}

TEST(FinalGather, IsExactInAFurnace) {
  for (const float rho : {0.0f, 0.5f, 0.99f}) {
    PatchScene builder;
    builder.room(1, 3, {rho, 2.0f});
    const Image image = gathered(builder, 2.0f, 2.0f * rho / (1.0f - rho)).render();
    for (std::size_t p = 0; p < image.pixels.size(); ++p) {
      EXPECT_NEAR(image.pixels[p].y * kPi, 2 / (1 - rho), 2e-3 / (1 - rho)) << rho;
      EXPECT_NEAR(colors(image, 0)[p].y * kPi, rho * 2, 2e-3);
      EXPECT_NEAR(colors(image, 1)[p].y * kPi, rho * rho * 2 / (1 - rho), 1e-3 / (1 - rho));
    }
  }
}

TEST(FinalGather, IsExactInsideASphereWhoseLightIsGathered) {
  PatchScene builder;
  builder.sphere({0, 0, 0}, -1, 4, 8, {0.5f, 2.0f});
  Solved solved = gathered(builder, 2.0f, 2.0f);
  solved.energy.groups[0].gathered_direct = solved.energy.groups[0].direct;
  const Image image = solved.render();
  for (std::size_t p = 0; p < image.pixels.size(); ++p) {
    EXPECT_NEAR(image.pixels[p].y * kPi, 4, 1e-4);
    EXPECT_NEAR(colors(image, 0)[p].y * kPi, 1, 1e-4) << "direct";
    EXPECT_NEAR(colors(image, 1)[p].y * kPi, 1, 1e-4) << "indirect";
  }
}

TEST(FinalGather, DoesNotUseTheSolutionAtThePixel) {
  PatchScene builder;
  builder.room(1, 3, {0.5f, 2.0f});
  Solved solved = gathered(builder, 2.0f, 2.0f);
  for (std::size_t i = 0; i < solved.scene.patches.size(); ++i)
    if (solved.scene.patches[i].primitive == 4)  // in front of the camera
      solved.energy.groups[0].indirect[i] = Color(1000.0f);
  solved.camera.vertical = 1.0;  // only that wall is visible
  for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y * kPi, 4, 4e-3);
}

TEST(FinalGather, CountsEmittersInMirrorsOnceTimesTheReflectance) {
  PatchScene builder, mirrored;
  builder.get().materials.push_back({"mirror", Color(0.5f, 0.25f, 1.0f), 0.0f});
  builder.quad({{{-90, -90, 2}, {-90, 90, 2}, {90, 90, 2}, {90, -90, 2}}}, 1, 1, {0.8f, 0.0f});
  builder.quad({{{-90, -90, -1}, {90, -90, -1}, {90, 90, -1}, {-90, 90, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.quad({{{2, -1.5, 0.5}, {2, 1.5, 0.5}, {5, 1.5, 0.5}, {5, -1.5, 0.5}}}, 1, 1,
               {0.0f, 5.0f});  // faces the mirror
  mirrored.quad({{{2, -1.5, -2.5}, {5, -1.5, -2.5}, {5, 1.5, -2.5}, {2, 1.5, -2.5}}}, 1, 1, {0.0f, 5.0f});
  Solved solved = gathered(builder, 0.0f, 0.0f);
  solved.camera.to_world.setAxisAngle(Vec3d(0, 1, 0), kPi);
  solved.camera.vertical = 1e-3;
  solved.job.trace.resolution = {1, 1};
  solved.job.trace.samples = 1;
  solved.job.trace.gather_rays = 1 << 16;
  const Image image = solved.render();
  const RayScene rays(mirrored.get());
  const DirectLight lamp(mirrored.get(), rays, explicit_emitters(mirrored.get()).at(0));
  const double irradiance = 5 * lamp.form_factor({0, 0, 2}, {0, 0, -1});
  ASSERT_GT(irradiance, 0.1);
  const Color indirect = colors(image, 1)[0];
  EXPECT_NEAR(indirect.x * kPi, 0.8 * 0.5 * irradiance, 0.01 * irradiance);
  EXPECT_NEAR(indirect.y * kPi, 0.8 * 0.25 * irradiance, 0.01 * irradiance);
  EXPECT_NEAR(indirect.z * kPi, 0.8 * 1.0 * irradiance, 0.01 * irradiance);
  EXPECT_EQ(colors(image, 0)[0], Color(0.0f)) << "the lamp faces away";
}

}  // namespace
}  // namespace patchlight

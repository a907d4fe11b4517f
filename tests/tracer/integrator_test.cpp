#include "tracer/integrator.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/expect_error.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

/// A solved scene in which every patch receives `direct` and `indirect` of group 0.
struct Solved {
  PatchSet scene;
  EnergyField energy;
  Job job;
  Camera camera;

  explicit Solved(PatchScene& builder, float direct = 2.0f, float indirect = 1.0f) : scene(builder.get()) {
    const std::size_t n = scene.patches.size();
    energy.groups = {{"light", std::vector<Color>(n, Color(direct)), std::vector<Color>(n, Color(indirect))}};
    job.trace.resolution = {8, 8};
    job.trace.samples = 4;
  }

  Image render() const {
    Progress progress({"test", true, ""});
    return Integrator(scene, energy, job).render(camera, progress);
  }
};

TEST(Integrator, ShowsEmissionAndReflectedIrradiance) {
  PatchScene builder;
  builder.room(1, 3, {0.5f, 4.0f});
  const Solved solved(builder);
  for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, (4 + 0.5 * 3) / kPi, 1e-5);
}

TEST(Integrator, RelightsByGroup) {
  PatchScene builder;
  builder.room(1, 3, {0.5f, 4.0f});
  Solved solved(builder);
  solved.job.lights["light"] = {2.0, Color(1.0f, 0.5f, 0.0f)};
  const Color pixel = solved.render().pixels[0];
  EXPECT_NEAR(pixel.x, 2 * 5.5 / kPi, 1e-5);
  EXPECT_NEAR(pixel.y, 5.5 / kPi, 1e-5);
  EXPECT_EQ(pixel.z, 0);
}

TEST(Integrator, RefusesAnUnknownLightGroup) {
  PatchScene builder;
  builder.room(1, 1, {});
  Solved solved(builder);
  solved.job.lights["lamp"].scale = 2;
  EXPECT_ERROR(solved.render(), ExitCode::bad_config, "unknown light group `lamp`");
}

/// A mirror 1 m before the camera, of reflectance `specular`, and a glowing wall 1 m behind it.
PatchScene mirror_scene(const Color& specular) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", specular, 0.0f});
  builder.quad({{{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.quad({{{-9, -9, 1}, {-9, 9, 1}, {9, 9, 1}, {9, -9, 1}}}, 1, 1, {0.0f, 3.0f});
  return builder;
}

TEST(Integrator, MirrorsShowWhatIsBeforeThem) {
  PatchScene builder = mirror_scene(Color(0.5f, 0.25f, 1.0f));
  const Solved solved(builder);
  for (const Color& pixel : solved.render().pixels) {
    EXPECT_NEAR(pixel.x, 0.5 * 3 / kPi, 1e-5);
    EXPECT_NEAR(pixel.y, 0.25 * 3 / kPi, 1e-5);
  }
}

TEST(Integrator, MirrorsShowAsMuchFromFarAway) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(1.0f), 0.0f});
  builder.quad({{{-0.01, -0.01, 0}, {0.01, -0.01, 0}, {0.01, 0.01, 0}, {-0.01, 0.01, 0}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  builder.quad({{{-9, -9, 400}, {-9, 9, 400}, {9, 9, 400}, {9, -9, 400}}}, 1, 1, {0.0f, 3.0f});
  Solved solved(builder);
  solved.camera.to_world.translate(Vec3d(0, 0, 300));
  solved.camera.vertical = 3e-5;  // the mirror fills the frame
  for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, 3 / kPi, 1e-5);
}

TEST(Integrator, EndsBetweenMirrorsThatFaceEachOther) {
  PatchScene builder;
  builder.get().materials[0] = {"mirror", Color(1.0f), 0.0f};
  builder.room(1, 1, {0.0f, 0.0f});
  const Solved solved(builder);
  for (const Color& pixel : solved.render().pixels) EXPECT_EQ(pixel, Color(0.0f));
}

TEST(Integrator, SeesBacksBlackOrLooksThroughThem) {
  PatchScene builder;
  builder.quad({{{-9, -9, -1}, {-9, 9, -1}, {9, 9, -1}, {9, -9, -1}}}, 1, 1, {});      // turned away
  builder.quad({{{-9, -9, -2}, {9, -9, -2}, {9, 9, -2}, {-9, 9, -2}}}, 1, 1, {0.5f});  // behind it
  Solved solved(builder);
  for (const Color& pixel : solved.render().pixels) EXPECT_EQ(pixel, Color(0.0f));
  solved.job.trace.cull_backfaces = true;
  for (const Color& pixel : solved.render().pixels) EXPECT_NEAR(pixel.y, 1.5 / kPi, 1e-5);
}

TEST(Integrator, EdgesAreTheShareOfThePixelThatIsCovered) {
  PatchScene builder;  // an emitter over the left 0.3 of the one pixel's width
  builder.quad({{{-1, -1, -1}, {-0.4, -1, -1}, {-0.4, 1, -1}, {-1, 1, -1}}}, 1, 1, {0.0f, float(kPi)});
  Solved solved(builder);
  solved.job.trace.resolution = {1, 1};
  solved.job.trace.samples = 256;
  solved.camera.vertical = kPi / 2;
  EXPECT_NEAR(solved.render().pixels[0].y, 0.3, 0.01);
}

TEST(Integrator, GivesTheSameBitsForAnyNumberOfThreads) {
  PatchScene builder;
  builder.room(1, 4, {0.5f, 1.0f});
  builder.sphere({0.2, 0, -0.6}, 0.3, 4, 6, {});
  Solved solved(builder);
  solved.job.trace.resolution = {40, 33};
  std::vector<Image> images;
  for (const std::size_t threads : {1, 2, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    images.push_back(solved.render());
  }
  EXPECT_EQ(images[1].pixels, images[0].pixels);
  EXPECT_EQ(images[2].pixels, images[0].pixels);
}

}  // namespace
}  // namespace patchlight

#include <gtest/gtest.h>

#include "tests/glass_scene.h"
#include "tests/tracer/solved_scene.h"

namespace patchlight {
namespace {

using test::add_level;
using test::PatchScene;
using test::Solved;

constexpr float kReflected = 0.3f;
const Color kPassed(0.5f, 0.25f, 0.0f);

/// A sheet at height 0, with both sides.
void add_sheet(PatchScene& builder) {
  PatchSet& scene = builder.get();
  scene.materials.push_back({"cloth"});
  scene.materials[1].translucence = kPassed;
  const int front = add_level(builder, 0, 2, true, {kReflected, 0.0f, 0, 1});
  const int back = add_level(builder, 0, 2, false, {kReflected, 0.0f, 0, 1});
  scene.primitives[front].back = back;
  scene.primitives[back].back = front;
}

/// Seen from above, with what falls on the sheet from above and below, W/m2.
Color seen(PatchScene& builder, const char* quality, float above, float below) {
  Solved solved(builder, 0.0f, 0.0f);
  solved.energy.groups[0].indirect[0] = Color(above);
  solved.energy.groups[0].indirect[1] = Color(below);
  solved.camera.to_world.rotate(Vec3d(-0.5 * kPi, 0, 0));
  solved.camera.to_world[3][1] = 3;
  solved.camera.vertical = 0.1;
  solved.job.trace.quality = quality;
  const Image image = solved.render();
  return image.pixels[27];
}

TEST(TranslucentFrames, AddWhatPassesFromTheOtherSide) {
  for (const char* quality : {"patches", "direct"}) {
    PatchScene builder;
    add_sheet(builder);
    const Color found = seen(builder, quality, 2.0f, 3.0f);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(found[k], (kReflected * 2 + kPassed[k] * 3) / kPi, 1e-5) << quality << ' ' << k;
  }
}

TEST(TranslucentFrames, ShowLampsBehindThem) {
  for (const char* quality : {"direct", "gather"}) {
    PatchScene builder;
    add_sheet(builder);
    Light sun = test::light_at({0, 0, 0}, Light::Kind::sun);
    sun.direction = {0, 1, 0};  // from below
    builder.get().lights.push_back(sun);
    const Color found = seen(builder, quality, 0.0f, 0.0f);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], kPassed[k] * sun.strength[k] / kPi, 1e-4) << quality << ' ' << k;
  }
}

TEST(TranslucentFrames, GatherTheSkyBehindThem) {
  PatchScene builder;
  add_sheet(builder);
  builder.get().environment = test::white_sky();
  const Color found = seen(builder, "gather", 0.0f, 0.0f);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], kReflected + kPassed[k], 1e-4) << k;
}

}  // namespace
}  // namespace patchlight

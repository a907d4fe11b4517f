#include "pipeline/optics/surface/smooth_normals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

/// The sides of an octagonal prism from y = 0 to 1, lit outside.
PatchScene prism(bool smooth) {
  PatchScene builder;
  const auto corner = [](int k, double y) { return Vec3d(std::cos(k * kPi / 4), y, std::sin(k * kPi / 4)); };
  for (int k = 0; k < 8; ++k) {
    const int index = builder.quad({{corner(k + 1, 0), corner(k, 0), corner(k, 1), corner(k + 1, 1)}}, 1, 1, {});
    const int left = (k + 1) % 8;
    builder.get().primitives[index].smooth_vertices = smooth ? std::array{2 * left, 2 * k, 2 * k + 1, 2 * left + 1}
                                                             : std::array{4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3};
  }
  return builder;
}

TEST(SmoothNormals, AreRadialOnACylinder) {
  PatchScene builder = prism(true);
  const PatchSet& scene = builder.get();
  const SmoothNormals normals(scene);
  for (std::int32_t i = 0; i < 8; ++i)
    for (const float u : {0.0f, 0.2f, 0.5f, 1.0f}) {
      const SurfacePoint point = point_at(scene.primitives[i], u, 0.7);
      const Vec3f radial = Vec3f(float(point.position.x), 0.0f, float(point.position.z)).normalized();
      EXPECT_GT(normals(i, u, 0.7f, point.normal) ^ radial, 0.9999f) << i << " " << u;
    }
}

TEST(SmoothNormals, StayFlatAtCreasesAndOnPlanes) {
  PatchScene builder = prism(false);
  builder.sphere({5, 0, 0}, 1, 3, 4, {});
  const PatchSet& scene = builder.get();
  const SmoothNormals normals(scene);
  for (std::int32_t i = 0; i < 9; ++i) {
    const Vec3f flat = point_at(scene.primitives[i], 0.1, 0.1).normal;
    EXPECT_EQ(normals(i, 0.1f, 0.1f, flat), flat);
  }
}

}  // namespace
}  // namespace patchlight

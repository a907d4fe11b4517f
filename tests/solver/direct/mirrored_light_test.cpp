#include "solver/direct/mirrored_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "solver/solve.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::light_at;
using test::PatchScene;

EnergyField solve_quietly(const PatchSet& scene, int rays = SolveConfig().rays) {
  SolveConfig config;
  config.rays = rays;
  config.display = false;
  Progress progress({"test", true, ""});
  return solve(scene, config, progress);
}

/// A tilted plane with a rectangle in it, and places seen in it as in a mirror.
struct Tilted {
  Vec3d origin{0.1, 0.4, -1.5}, right{1, 0, 0}, up = Vec3d(0, 1, 0.2).normalized();

  Vec3d at(double x, double y) const { return origin + right * x + up * y; }
  Vec3d mirrored(const Vec3d& p) const {
    const Vec3d normal = right % up;
    return p - normal * (2 * ((p - origin) ^ normal));
  }
  std::array<Vec3d, 4> rectangle(double x0, double y0, double x1, double y1) const {
    return {at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)};
  }
};

/// Adds emitters, each place of which goes through `place`; `turned`: whether that reflects.
using AddEmitters =
    std::function<void(PatchScene& builder, const std::function<Vec3d(const Vec3d&)>& place, bool turned)>;

void add_quad(PatchScene& builder, const std::array<Vec3d, 4>& corners, const PatchScene::Surface& surface,
              const std::function<Vec3d(const Vec3d&)>& place, bool turned) {
  std::array<Vec3d, 4> placed;
  for (int k = 0; k < 4; ++k) placed[k] = place(corners[turned ? 3 - k : k]);
  builder.quad(placed, 1, 1, surface);
}

/// Root mean square and mean of the error of light that a mirror brings to a floor, over what comes through a window
/// to the mirrored world, where a board stands in the way.
struct MirrorErrors {
  double rms, mean;

  explicit MirrorErrors(const AddEmitters& add_emitters) {
    constexpr int kCells = 20;
    const Tilted plane;
    PatchScene mirror, window;
    mirror.get().materials.push_back({"mirror", Color(0.8f), 0.0f});
    for (PatchScene* builder : {&mirror, &window}) {
      builder->quad({{{-2, 0, -1.4}, {-2, 0, 2.6}, {2, 0, 2.6}, {2, 0, -1.4}}}, kCells, kCells, {0.0f});
      add_quad(
          *builder, {{{-0.2, 0.5, -0.6}, {0.5, 0.5, -0.6}, {0.5, 1.4, -0.6}, {-0.2, 1.4, -0.6}}}, {0.0f},
          [](const Vec3d& p) { return p; }, false);
    }
    mirror.quad(plane.rectangle(-0.7, 0, 0.7, 1.6), 1, 1, {0.0f, 0.0f, 0, 1});
    window.quad(plane.rectangle(-90, -90, -0.7, 90), 1, 1, {0.0f});
    window.quad(plane.rectangle(0.7, -90, 90, 90), 1, 1, {0.0f});
    window.quad(plane.rectangle(-0.7, -90, 0.7, 0), 1, 1, {0.0f});
    window.quad(plane.rectangle(-0.7, 1.6, 0.7, 90), 1, 1, {0.0f});
    add_quad(
        window, {{{-0.2, 0.5, -0.6}, {0.5, 0.5, -0.6}, {0.5, 1.4, -0.6}, {-0.2, 1.4, -0.6}}}, {0.0f},
        [&](const Vec3d& p) { return plane.mirrored(p); }, true);
    add_emitters(
        mirror, [](const Vec3d& p) { return p; }, false);
    add_emitters(
        window, [&](const Vec3d& p) { return plane.mirrored(p); }, true);
    const EnergyField seen = solve_quietly(mirror.get()), known = solve_quietly(window.get(), 1 << 12);
    double squares = 0, all = 0, sum = 0, exact = 0;
    for (int i = 0; i < kCells * kCells; ++i) {
      const double want = 0.8 * known.groups[0].direct[i].x, got = seen.groups[0].indirect[i].x;
      squares += (got - want) * (got - want);
      all += want * want;
      sum += got;
      exact += want;
    }
    EXPECT_GT(exact, 0);
    rms = std::sqrt(squares / all);
    mean = sum / exact - 1;
  }
};

TEST(MirroredLight, IsThatOfTheVirtualImage) {
  const auto quad = [](const std::array<Vec3d, 4>& corners) -> AddEmitters {
    return [=](PatchScene& builder, const auto& place, bool turned) {
      add_quad(builder, corners, {0.0f, 1.0f}, place, turned);
    };
  };
  const auto light = [](Light::Kind kind, double inner, double outer, double radius = 0) -> AddEmitters {
    return [=](PatchScene& builder, const auto& place, bool) {
      Light l = light_at({0.2, 2.2, 0.3}, kind);
      l.radius = radius;
      l.inner = inner;
      l.outer = outer;
      const Vec3d toward = l.position + Vec3d(-0.1, -0.6, -0.8).normalized();
      l.direction = (place(toward) - place(l.position)).normalized();
      l.position = place(l.position);
      builder.get().lights.push_back(l);
    };
  };
  const std::array<std::pair<const char*, AddEmitters>, 9> kinds{{
      {"quad", quad({{{-0.3, 1.9, 0}, {0.3, 1.8, 0}, {0.3, 2.0, 0.5}, {-0.3, 2.1, 0.5}}})},
      {"triangle", quad({{{-0.4, 1.9, 0}, {0.4, 1.9, 0}, {0.0, 2.1, 0.5}, {0.0, 2.1, 0.5}}})},
      {"sphere",
       [](PatchScene& builder, const auto& place, bool) {
         builder.sphere(place({0.2, 1.6, 0.4}), 0.2, 1, 1, {0.0f, 1.0f});
       }},
      {"point light", light(Light::Kind::point, 0, 0)},
      {"point light with a radius", light(Light::Kind::point, 0, 0, 0.2)},
      {"spot light", light(Light::Kind::spot, 0.3, 0.6)},
      {"spot light with a radius", light(Light::Kind::spot, 0.3, 0.6, 0.2)},
      {"sun", light(Light::Kind::sun, 0, 0)},
      {"sun with a radius", light(Light::Kind::sun, 0, 0.03)},
  }};
  for (const auto& [name, add] : kinds) {
    const MirrorErrors errors(add);
    EXPECT_NEAR(errors.mean, 0, 0.01) << name;
    EXPECT_LT(errors.rms, 0.02) << name;
  }
}

/// Power that metals reflect onto all patches, for an exitance of 1.
double power(const PatchSet& scene, const std::vector<Color>& factors) {
  double sum = 0;
  for (std::size_t k = 0; k < factors.size(); ++k) sum += 0.5 * factors[k].y * scene.patches[k / 2].area;
  return sum;
}

TEST(MirroredLight, IsNeitherLostNorDoubledBesidePhotons) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(0.8f), 0.0f});
  builder.room(1, 4, {0.5f});
  const PatchScene::Surface mirror{0.0f, 0.0f, 0, 1};
  builder.quad({{{-0.9, -0.8, 0.5}, {-0.9, -0.8, -0.5}, {-0.9, 0.3, -0.5}, {-0.9, 0.3, 0.5}}}, 2, 2, mirror);
  builder.quad({{{0.9, -0.8, -0.5}, {0.9, -0.8, 0.5}, {0.7, 0.3, 0.5}, {0.7, 0.3, -0.5}}}, 2, 2, mirror);
  builder.sphere({0.2, -0.5, 0.3}, 0.3, 6, 12, mirror);
  builder.quad({{{-0.1, 0.8, -0.1}, {0.1, 0.8, -0.1}, {0.1, 0.8, 0.1}, {-0.1, 0.8, 0.1}}}, 1, 1, {0.0f, 1.0f});
  const PatchSet& scene = builder.get();
  const RayScene ray_scene(scene);
  const PatchLookup lookup(scene);
  const Lattices lattices(scene, lookup);
  const DirectFactors direct(scene, ray_scene, scene.patches, grid_neighbours(scene, lookup, lattices), 1);
  const Emitter emitter = explicit_emitters(scene).at(0);
  ASSERT_EQ(plane_mirrors(scene, ray_scene).size(), 2u);
  std::int64_t cast = 0;
  const double by_photons = power(scene, Photons(scene, ray_scene, 1).shoot(emitter, 4'000'000, cast));
  const auto mirrored = MirroredLight(scene, ray_scene, direct, 1).sample(emitter, 1, 1 << 16, {}, cast);
  EXPECT_NEAR(power(scene, mirrored) / by_photons, 1, 0.005);
}

}  // namespace
}  // namespace patchlight

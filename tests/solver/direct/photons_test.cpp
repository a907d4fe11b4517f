#include "solver/direct/photons.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "solver/form_factors/ray_rows.h"
#include "solver/solve.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

std::vector<Color> shoot(const PatchSet& scene, std::int64_t photons, std::uint64_t seed = 1) {
  const RayScene ray_scene(scene);
  std::int64_t cast = 0;
  return Photons(scene, ray_scene, seed).shoot(explicit_emitters(scene).at(0), photons, cast);
}

/// Specularly reflected irradiance by the only emitter's exitance of 1, from rows of form factors; green channel.
std::vector<double> gathered(const PatchSet& scene, int rays, std::uint64_t seed) {
  const RayScene ray_scene(scene);
  Progress progress({"test", true, ""});
  TransportRows rows;
  RayRows(scene, ray_scene, scene.patches, Elements(scene), seed).cast(rays, rows, progress);
  std::vector<double> received(scene.patches.size());
  for (const auto& m : rows.mirrored)
    if (scene.patches[m.patch].emission.y > 0) received[m.row] += 0.5 * m.weight.y;
  return received;
}

std::vector<double> by_photons(const PatchSet& scene, std::int64_t photons, std::uint64_t seed) {
  std::vector<double> received;
  const std::vector<Color> factors = shoot(scene, photons, seed);
  for (std::size_t k = 0; k < factors.size(); k += 2) received.push_back(0.5 * (factors[k].y + factors[k + 1].y));
  return received;
}

/// Specularly reflected power that patches receive, over the emitted power.
double arrived(const PatchSet& scene, const std::vector<Color>& factors) {
  double power = 0;
  for (std::size_t k = 0; k < factors.size(); ++k) power += 0.5 * factors[k].y * scene.patches[k / 2].area;
  return power / explicit_emitters(scene).at(0).area;
}

/// A room with a small lamp, a mirror, a tilted half-mirror, a rough metal sphere and a mirror sphere.
PatchScene mirror_room(double lamp = 0.1) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(0.9f, 0.8f, 0.7f), 0.0f});
  builder.get().materials.push_back({"half-mirror", Color(0.5f), 0.0f});
  builder.get().materials.push_back({"rough", Color(0.7f), 0.4f});
  builder.room(1, 4, {0.5f, 0.0f});
  builder.quad({{{-0.9, -0.8, -0.5}, {-0.9, 0.3, -0.5}, {-0.9, 0.3, 0.5}, {-0.9, -0.8, 0.5}}}, 2, 2,
               {0.0f, 0.0f, 0, 1});
  builder.quad({{{0.9, -0.8, 0.5}, {0.7, 0.3, 0.5}, {0.7, 0.3, -0.5}, {0.9, -0.8, -0.5}}}, 2, 2, {0.4f, 0.0f, 0, 2});
  builder.sphere({0.2, -0.5, 0.3}, 0.3, 6, 12, {0.0f, 0.0f, 0, 1});
  builder.sphere({-0.3, -0.6, -0.4}, 0.25, 6, 12, {0.2f, 0.0f, 0, 3});
  const double l = 0.5 * lamp;
  builder.quad({{{-l, 0.8, -l}, {l, 0.8, -l}, {l, 0.8, l}, {-l, 0.8, l}}}, 1, 1, {0.0f, 1.0f});
  return builder;
}

/// Means over seeds and their squared standard errors.
struct Means {
  std::vector<double> mean, square;

  template <class Estimate>
  Means(int seeds, std::size_t patches, Estimate estimate) : mean(patches), square(patches) {
    std::vector<std::vector<double>> all;
    for (int seed = 0; seed < seeds; ++seed) {
      all.push_back(estimate(std::uint64_t(seed)));
      for (std::size_t i = 0; i < patches; ++i) mean[i] += all.back()[i] / seeds;
    }
    for (const auto& one : all)
      for (std::size_t i = 0; i < patches; ++i) square[i] += std::pow(one[i] - mean[i], 2) / (seeds * (seeds - 1));
  }
};

TEST(Photons, AgreeWithManyRaysPatchByPatch) {
  PatchScene builder = mirror_room(0.6);
  const PatchSet& scene = builder.get();
  const std::size_t n = scene.patches.size();
  const Means photons(8, n, [&](std::uint64_t seed) { return by_photons(scene, 100'000, seed); });
  const Means rows(8, n, [&](std::uint64_t seed) { return gathered(scene, 4096, seed); });
  int outliers = 0, lit = 0;
  double squares = 0, difference = 0, all = 0, error = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double area = scene.patches[i].area;
    const double deviation = photons.mean[i] - rows.mean[i], square = photons.square[i] + rows.square[i];
    difference += area * deviation;
    all += area * photons.mean[i];
    error += area * area * square;
    if (rows.mean[i] < 1e-4) continue;  // too few rays for an estimate of the variance
    squares += deviation * deviation / square;
    outliers += deviation * deviation > 25 * square;
    ++lit;
  }
  EXPECT_GT(lit, 150);
  EXPECT_LT(std::sqrt(error), 0.01 * all);
  EXPECT_LT(std::abs(difference), 4 * std::sqrt(error));
  // Student's t of some 10 degrees of freedom: beyond 5 once in 2000, mean square 1.25.
  EXPECT_LE(outliers, 3);
  EXPECT_LT(squares / lit, 1.6);
}

TEST(Photons, AreFarLessNoisyThanSixteenTimesAsManyRays) {
  PatchScene builder = mirror_room();
  const PatchSet& scene = builder.get();
  const std::size_t n = scene.patches.size();
  const std::vector<double> truth = by_photons(scene, 1'000'000, 1);
  const auto noise = [&](const std::vector<double>& received) {
    double square = 0, norm = 0;
    for (std::size_t i = 0; i < n; ++i) {
      square += scene.patches[i].area * std::pow(received[i] - truth[i], 2);
      norm += scene.patches[i].area * truth[i] * truth[i];
    }
    return std::sqrt(square / norm);
  };
  constexpr int kRays = 256;
  const double of_rows = noise(gathered(scene, kRays, 7)), of_photons = noise(by_photons(scene, n * kRays / 16, 7));
  EXPECT_LT(of_photons, 0.2 * of_rows) << of_rows;
}

TEST(Photons, ConserveEnergyBetweenFacingMirrors) {
  for (const float specular : {0.5f, 0.9f}) {
    PatchScene builder;
    builder.get().materials[0] = {"mirror", Color(specular), 0.0f};
    builder.room(1, 2, {0.0f, 0.0f});
    PatchSet& scene = builder.get();
    scene.primitives[3].light_group = 0;
    for (int i = 12; i < 16; ++i) scene.patches[i].emission = Color(1.0f);
    const double expected = specular / (1 - specular);  // geometric series of reflections
    EXPECT_NEAR(arrived(scene, shoot(scene, 100'000)), expected, 0.01 * expected);
  }
}

TEST(Photons, TerminateBetweenPerfectMirrors) {
  PatchScene builder;
  builder.get().materials[0] = {"mirror", Color(1.0f), 0.0f};
  builder.room(1, 1, {0.0f, 1.0f});
  for (const Color& factor : shoot(builder.get(), 1000)) EXPECT_LT(factor.y, 300);
}

/// A faceted bowl around a lamp, with its planes in separate nodes or in one.
TEST(Photons, GiveTheSamePowerForOneTargetAsForManyPlanes) {
  const auto bowl = [](bool one_node) {
    PatchScene builder;
    PatchSet& scene = builder.get();
    scene.materials.push_back({"mirror", Color(0.8f), 0.0f});
    builder.quad({{{-0.1, 0, -0.1}, {0.1, 0, -0.1}, {0.1, 0, 0.1}, {-0.1, 0, 0.1}}}, 1, 1, {0.0f, 1.0f});
    const auto at = [](int k, double radius, double y) {
      return Vec3d(radius * std::sin(kPi * k / 6), y, radius * std::cos(kPi * k / 6));
    };
    for (int k = 0; k < 12; ++k) {
      builder.quad({at(k, 0.2, -0.7), at(k + 1, 0.2, -0.7), at(k + 1, 0.6, 0.2), at(k, 0.6, 0.2)}, 1, 1,
                   {0.0f, 0.0f, 0, 1});
      std::reverse(scene.primitives.back().corners.begin(), scene.primitives.back().corners.end());
      scene.primitives.back().node = one_node ? 0 : k;
      scene.nodes.resize(12);
    }
    builder.quad({{{-3, 3, -3}, {3, 3, -3}, {3, 3, 3}, {-3, 3, 3}}}, 1, 1, {0.0f, 0.0f});
    return builder;
  };
  PatchScene separate = bowl(false), together = bowl(true);
  const double expected = arrived(separate.get(), shoot(separate.get(), 200'000));
  EXPECT_GT(expected, 0.5);
  EXPECT_NEAR(arrived(together.get(), shoot(together.get(), 200'000)), expected, 0.01 * expected);
}

TEST(Photons, AreTheSameForAnyNumberOfThreads) {
  PatchScene builder = mirror_room();
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return shoot(builder.get(), 20'000);
  };
  EXPECT_EQ(with_threads(1), with_threads(3));
}

struct Solved {
  EnergyField energy;
  Transport transport;

  void solve_again(const PatchSet& scene) {
    SolveConfig config;
    config.rays = 256;
    config.tolerance = 1e-6;
    Progress progress({"test", true, ""});
    energy = solve(scene, config, transport, progress);
  }
};

/// Everything but a perfect mirror has exitance 1, of an explicitly sampled emitter and of a gathered shell, so the
/// irradiance is 1 everywhere.
TEST(Photons, NeitherLoseNorDuplicateLightInAFurnaceWithAMirror) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", Color(1.0f), 0.0f});
  builder.sphere({0, 0, 0}, -2, 12, 18, {0.0f, 1.0f});
  builder.sphere({0.5, 0.4, 0}, 0.5, 8, 12, {0.0f, 1.0f});
  builder.sphere({-0.6, -0.4, 0.2}, 0.6, 4, 8, {0.0f, 0.0f, 0, 1});
  const PatchSet& scene = builder.get();
  Solved solved;
  solved.solve_again(scene);
  ASSERT_EQ(solved.transport.emitters.size(), 1u);
  ASSERT_FALSE(solved.transport.emitters[0].mirrored.empty());
  double mean = 0, area = 0;
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    const EnergyField::Group& group = solved.energy.groups[0];
    mean += scene.patches[i].area * (group.direct[i].y + group.indirect[i].y);
    area += scene.patches[i].area;
  }
  EXPECT_NEAR(mean / area, 1, 1e-3);
}

TEST(Photons, NeedNoRaysForOtherColoursAndExitances) {
  PatchScene builder = mirror_room();
  PatchSet& scene = builder.get();
  Solved solved;
  solved.solve_again(scene);
  const std::vector<Color> first = solved.energy.groups[0].over_metals;
  for (Patch& patch : scene.patches) {
    patch.reflectance *= 0.5f;
    patch.emission *= 2.0f;
  }
  solved.solve_again(scene);
  EXPECT_EQ(solved.energy.rays, 0);
  double before = 0, after = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    before += first[i].y * scene.patches[i].area;
    after += solved.energy.groups[0].over_metals[i].y * scene.patches[i].area;
  }
  EXPECT_NEAR(after / before, 2, 0.01) << "the filter may choose other windows";
}

TEST(Photons, OfALightWithARadiusAreThoseOfAShiningBall) {
  constexpr double kRadius = 0.08;
  for (const double x : {0.0, 0.45}) {  // outside of all metals' bounds, and close to a ball
    const Vec3d at(x, 0.1, 0.3);
    PatchScene with_light = mirror_room(), with_ball = mirror_room();
    for (PatchScene* builder : {&with_light, &with_ball}) {
      builder->get().primitives.back().light_group = -1;
      builder->get().patches.back().emission = Color(0.0f);
    }
    with_light.get().lights = {test::light_at(at)};
    with_light.get().lights[0].radius = kRadius;
    with_ball.sphere(at, kRadius, 1, 1, {0.0f, 1.0f});
    const std::vector<double> light = by_photons(with_light.get(), 1 << 20, 1);
    const std::vector<double> ball = by_photons(with_ball.get(), 1 << 20, 1);
    double sum = 0, expected = 0, squares = 0, all = 0;
    for (std::size_t i = 0; i < light.size(); ++i) {
      const double area = with_light.get().patches[i].area, want = ball[i] / (kRadius * kRadius);
      sum += area * light[i];
      expected += area * want;
      squares += area * std::pow(light[i] - want, 2);
      all += area * want * want;
    }
    EXPECT_NEAR(sum / expected, 1, 0.04) << x;  // the ball hides some of what the metals reflect
    EXPECT_LT(std::sqrt(squares / all), 0.1) << x;
  }
}

TEST(Photons, CostNothingWithoutMetals) {
  PatchScene builder = mirror_room();
  for (Material& material : builder.get().materials) material.specular = Color(0.0f);
  Solved solved;
  solved.solve_again(builder.get());
  EXPECT_TRUE(solved.transport.emitters.at(0).mirrored.empty());
  EXPECT_TRUE(solved.energy.groups[0].over_metals.empty());
}

TEST(Photons, CountOnceAtVerticesOfTheDisplaySolution) {
  PatchScene builder = mirror_room();
  PatchSet& scene = builder.get();
  for (Patch& patch : scene.patches) patch.reflectance = Color(0.0f);
  Solved solved;
  solved.solve_again(scene);
  const EnergyField::Group& group = solved.energy.groups[0];
  double shown = 0, known = 0;
  ASSERT_GT(group.display.size(), 100u);
  for (std::size_t k = 0; k < group.display.size(); ++k) {
    shown += group.display[k].y;
    known += group.indirect[solved.energy.display->vertices[k].patch].y;
  }
  EXPECT_GT(known, 0);
  EXPECT_NEAR(shown / known, 1, 0.05) << "only metals reflect";
}

}  // namespace
}  // namespace patchlight

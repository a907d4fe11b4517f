#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "solver/form_factors/ray_rows.h"
#include "tests/end_to_end/hard_cases/lambert_factor.h"
#include "tests/window_room.h"

namespace patchlight {
namespace {

using test::Corners;
using test::kFloorAcross;
using test::kFloorDeep;
using test::room_with_window;

TransportRows cast(const PatchSet& scene, int rays, std::uint64_t seed = 1) {
  const RayScene ray_scene(scene);
  Progress progress({"test", true, ""});
  TransportRows rows;
  RayRows(scene, ray_scene, scene.patches, Elements(scene), seed, true).cast(rays, rows, progress);
  return rows;
}

/// Form factor of a sample set to the environment.
double sky_factor(const TransportRows& rows, std::size_t segment, std::size_t patches) {
  double sum = 0;
  for (std::uint64_t at = rows.starts[segment]; at < rows.starts[segment + 1]; ++at)
    if (std::size_t(rows.columns[at]) >= patches) sum += rows.hit_weights[segment];
  if (!rows.sky_starts.empty())
    sum += double(rows.sky_weights[segment]) * double(rows.sky_starts[segment + 1] - rows.sky_starts[segment]);
  return sum;
}

struct Errors {
  double mean = 0, rms = 0;
};

/// Errors of the floor's form factors to the window, relative to each, where they are 1 m or more from the window's
/// wall.
Errors window_errors(double left, double right, double bottom, double top, int seeds) {
  const PatchSet scene = room_with_window(left, right, bottom, top);
  const Corners window{{{left, bottom, 0}, {left, top, 0}, {right, top, 0}, {right, bottom, 0}}};
  Errors errors;
  int count = 0;
  std::vector<double> exact;
  for (int i = 0; i < kFloorAcross * kFloorDeep; ++i)
    exact.push_back(test::patch_factor(scene, scene.patches[i], {window}));
  for (int seed = 1; seed <= seeds; ++seed) {
    const TransportRows rows = cast(scene, 256, std::uint64_t(seed));
    for (int i = 0; i < kFloorAcross * kFloorDeep; ++i) {
      if (5.6 * (1 - double(scene.patches[i].u1)) < 1.0) continue;
      const double factor = 0.5 * (sky_factor(rows, 2 * std::size_t(i), scene.patches.size()) +
                                   sky_factor(rows, 2 * std::size_t(i) + 1, scene.patches.size()));
      const double error = factor / exact[i] - 1;
      errors.mean += error;
      errors.rms += error * error;
      ++count;
    }
  }
  return {errors.mean / count, std::sqrt(errors.rms / count)};
}

TEST(GuidedRows, FindAWindowAsLambertsFormulaDoes) {
  const Errors errors = window_errors(-0.96, 0.96, 0.8, 2.3, 4);
  EXPECT_LT(errors.rms, 0.04);
  EXPECT_NEAR(errors.mean, 0, 0.002);
}

TEST(GuidedRows, FindASmallWindowWithoutBias) {
  const Errors errors = window_errors(0.3, 0.7, 1.5, 1.9, 40);
  EXPECT_LT(errors.rms, 0.3);
  EXPECT_NEAR(errors.mean, 0, 0.01);  // three standard errors
}

TEST(GuidedRows, AddUpToOneWithWhatTheyFind) {
  const PatchSet scene = room_with_window(-0.96, 0.96, 0.8, 2.3);
  const TransportRows rows = cast(scene, 256);
  ASSERT_FALSE(rows.sky_columns.empty());
  int guided = 0;
  for (std::size_t k = 0; k < 2 * std::size_t(kFloorAcross * kFloorDeep); ++k) {
    const double columns = double(rows.starts[k + 1] - rows.starts[k]) * double(rows.hit_weights[k]);
    const double sky = double(rows.sky_starts[k + 1] - rows.sky_starts[k]) * double(rows.sky_weights[k]);
    EXPECT_NEAR(columns + sky, 1, 1e-5);
    guided += sky > 0;
  }
  EXPECT_GT(guided, kFloorAcross * kFloorDeep);  // more than half
}

TEST(GuidedRows, DoNotDependOnThreads) {
  const PatchSet scene = room_with_window(-0.96, 0.96, 0.8, 2.3);
  const TransportRows many = cast(scene, 64);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const TransportRows alone = cast(scene, 64);
  EXPECT_EQ(many.columns, alone.columns);
  EXPECT_EQ(many.hit_weights, alone.hit_weights);
  EXPECT_EQ(many.sky_starts, alone.sky_starts);
  EXPECT_EQ(many.sky_columns, alone.sky_columns);
  EXPECT_EQ(many.sky_weights, alone.sky_weights);
}

TEST(GuidedRows, AreNoneOutdoors) {
  PatchSet scene = room_with_window(-0.96, 0.96, 0.8, 2.3);
  scene.primitives.resize(1);
  scene.patches.resize(std::size_t(kFloorAcross * kFloorDeep));
  const TransportRows rows = cast(scene, 64);
  EXPECT_TRUE(rows.sky_starts.empty() && rows.sky_columns.empty() && rows.sky_weights.empty());
  EXPECT_EQ(rows.columns.size(), scene.patches.size() * 64);
}

}  // namespace
}  // namespace patchlight

#include "solver/transport/transport_shards.h"

#include <gtest/gtest.h>

#include "pipeline/formats/solution/transport_shard_file.h"
#include "solver/solve.h"
#include "tests/expect_error.h"
#include "tests/patch_scene.h"
#include "tests/temporary_folder.h"
#include "tests/window_room.h"

namespace patchlight {
namespace {

using test::PatchScene;
using test::TemporaryFolder;

/// A room with a lamp, a mirror, and a block on the floor whose surfaces are unlit inside.
PatchSet mirror_room() {
  PatchScene scene;
  scene.room(1, 6, {0.5f});
  scene.quad({{{-0.2, 0.9, -0.2}, {0.2, 0.9, -0.2}, {0.2, 0.9, 0.2}, {-0.2, 0.9, 0.2}}}, 1, 1, {0.0f, 10.0f});
  scene.get().materials.push_back({"mirror", Color(0.9f), 0.0f});
  scene.quad({{{-0.9, -0.5, -0.5}, {-0.9, 0.5, -0.5}, {-0.9, 0.5, 0.5}, {-0.9, -0.5, 0.5}}}, 2, 2, {0.0f, 0.0f, 0, 1});
  scene.quad({{{0.11, -0.7, 0.13}, {0.11, -0.7, 0.57}, {0.63, -0.7, 0.57}, {0.63, -0.7, 0.13}}}, 2, 2, {0.5f});
  scene.quad({{{0.11, -1, 0.57}, {0.63, -1, 0.57}, {0.63, -0.7, 0.57}, {0.11, -0.7, 0.57}}}, 2, 1, {0.5f});
  scene.quad({{{0.63, -1, 0.13}, {0.11, -1, 0.13}, {0.11, -0.7, 0.13}, {0.63, -0.7, 0.13}}}, 2, 1, {0.5f});
  scene.quad({{{0.11, -1, 0.13}, {0.11, -1, 0.57}, {0.11, -0.7, 0.57}, {0.11, -0.7, 0.13}}}, 1, 2, {0.5f});
  scene.quad({{{0.63, -1, 0.57}, {0.63, -1, 0.13}, {0.63, -0.7, 0.13}, {0.63, -0.7, 0.57}}}, 1, 2, {0.5f});
  return scene.get();
}

class TransportShards : public ::testing::Test {
 protected:
  void SetUp() override {
    job_.output = folder_.path();
    job_.solve.rays = 100;
  }

  void cast(Shard shard) {
    TransportShard rows = cast_transport_shard(scene_, job_.solve, shard, progress_);
    rows.key = transport_shard_key(job_, scene_, shard);
    write_transport_shard(transport_shard_file(job_, shard), rows);
  }

  Transport merge(int count) {
    cast_ = 0;
    return merge_transport_shards(job_, scene_, count, cast_, progress_);
  }

  static void expect_equal(const TransportRows& a, const TransportRows& b) {
    EXPECT_EQ(a.starts, b.starts);
    EXPECT_EQ(a.columns, b.columns);
    EXPECT_EQ(a.hit_weights, b.hit_weights);
    EXPECT_EQ(a.visible_fractions, b.visible_fractions);
    EXPECT_EQ(a.rays, b.rays);
    EXPECT_EQ(a.sky_starts, b.sky_starts);
    EXPECT_EQ(a.sky_columns, b.sky_columns);
    EXPECT_EQ(a.sky_weights, b.sky_weights);
    ASSERT_EQ(a.mirrored.size(), b.mirrored.size());
    for (std::size_t k = 0; k < a.mirrored.size(); ++k) {
      EXPECT_EQ(a.mirrored[k].row, b.mirrored[k].row);
      EXPECT_EQ(a.mirrored[k].sample_set, b.mirrored[k].sample_set);
      EXPECT_EQ(a.mirrored[k].patch, b.mirrored[k].patch);
      EXPECT_EQ(a.mirrored[k].weight, b.mirrored[k].weight);
    }
  }

  PatchSet scene_ = mirror_room();
  TemporaryFolder folder_;
  Job job_;
  Progress progress_{{"test", true, ""}};
  std::int64_t cast_ = 0;
};

TEST_F(TransportShards, GiveTheRowsAndSolutionOfASingleSolve) {
  Transport whole;
  const EnergyField alone = solve(scene_, job_.solve, whole, progress_);
  ASSERT_FALSE(whole.mirrored.empty());
  ASSERT_FALSE(whole.visible_fractions.empty());
  ASSERT_GT(whole.display->mesh.gathered, 10);
  for (const int count : {1, 3, 7}) {
    SCOPED_TRACE(count);
    for (int k = 1; k <= count; ++k) cast({k, count});
    Transport merged = merge(count);
    EXPECT_TRUE(merged.changed);
    expect_equal(merged, whole);
    expect_equal(merged.display->rows, whole.display->rows);
    const EnergyField energy = solve(scene_, job_.solve, merged, progress_);
    EXPECT_EQ(energy.rays + cast_, alone.rays);
    ASSERT_EQ(energy.groups.size(), 1u);
    EXPECT_EQ(energy.groups[0].direct, alone.groups[0].direct);
    EXPECT_EQ(energy.groups[0].indirect, alone.groups[0].indirect);
    EXPECT_EQ(energy.groups[0].display, alone.groups[0].display);
    EXPECT_EQ(merged.emitters.at(0).factors, whole.emitters.at(0).factors);
    EXPECT_EQ(merged.emitters[0].mirrored, whole.emitters[0].mirrored);
  }
}

TEST_F(TransportShards, GiveTheRowsOfASingleSolveThroughAWindow) {
  scene_ = test::room_with_window(-0.96, 0.96, 0.8, 2.3, 0.5f);
  Transport whole;
  const EnergyField alone = solve(scene_, job_.solve, whole, progress_);
  ASSERT_FALSE(whole.sky_columns.empty());
  ASSERT_FALSE(whole.display->rows.sky_columns.empty());
  for (const int count : {2, 5}) {
    SCOPED_TRACE(count);
    for (int k = 1; k <= count; ++k) cast({k, count});
    Transport merged = merge(count);
    expect_equal(merged, whole);
    expect_equal(merged.display->rows, whole.display->rows);
    EXPECT_EQ(solve(scene_, job_.solve, merged, progress_).groups[0].indirect, alone.groups[0].indirect);
  }
}

TEST_F(TransportShards, HaveOnlyPatchRowsWithoutADisplaySolution) {
  job_.solve.display = false;
  Transport whole;
  solve(scene_, job_.solve, whole, progress_);
  const int count = int(scene_.patches.size()) + 20;  // some shards have no rows
  for (int k = 1; k <= count; ++k) cast({k, count});
  Transport merged = merge(count);
  expect_equal(merged, whole);
  EXPECT_FALSE(merged.display);
}

TEST_F(TransportShards, AreRefusedIfOneIsMissingOrOfAnotherJob) {
  for (int k = 1; k <= 3; ++k) cast({k, 3});
  std::filesystem::remove(transport_shard_file(job_, {2, 3}));
  EXPECT_ERROR(merge(3), ExitCode::missing_input, "transport.2-of-3.h5): run patchlight-solve --shard 2/3");
  job_.solve.seed = 2;
  cast({2, 3});
  job_.solve.seed = 1;
  EXPECT_ERROR(merge(3), ExitCode::bad_data, "was cast for another scene or other settings");
  std::filesystem::copy_file(transport_shard_file(job_, {3, 3}), transport_shard_file(job_, {2, 3}),
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_ERROR(merge(3), ExitCode::bad_data, "was cast for another scene or other settings");
  folder_.write("transport.2-of-3.h5", "damaged");
  EXPECT_ERROR(merge(3), ExitCode::bad_data, "transport.2-of-3.h5");

  // Shards with the right key and the wrong content.
  TransportShard rows = cast_transport_shard(scene_, job_.solve, {2, 3}, progress_);
  rows.key = transport_shard_key(job_, scene_, {2, 3});
  TransportShard fewer = rows;
  fewer.rows.starts = {0};
  fewer.rows.columns.clear();
  fewer.rows.hit_weights.clear();
  fewer.rows.visible_fractions.clear();
  fewer.rows.mirrored.clear();
  write_transport_shard(transport_shard_file(job_, {2, 3}), fewer);
  EXPECT_ERROR(merge(3), ExitCode::bad_data, "does not have the expected rows");
  rows.display_rows.reset();
  write_transport_shard(transport_shard_file(job_, {2, 3}), rows);
  EXPECT_ERROR(merge(3), ExitCode::bad_data, "does not have the expected rows");
}

}  // namespace
}  // namespace patchlight

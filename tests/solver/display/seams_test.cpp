#include "solver/display/seams.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/patch_scene.h"

namespace patchlight::test {
namespace {

/// A level quad from (x, z) on that faces up.
std::array<Vec3d, 4> level(double x, double z, double width, double depth) {
  return {{{x, 0, z}, {x, 0, z + depth}, {x + width, 0, z + depth}, {x + width, 0, z}}};
}

/// Two tiles with cells of 1 m, one with cells of 0.5 m beyond them, and one apart.
PatchScene tiles() {
  PatchScene builder;
  builder.quad(level(0, 0, 4, 4), 4, 4, {});
  builder.quad(level(4, 0, 4, 4), 4, 4, {});
  builder.quad(level(0, 4, 4, 4), 8, 8, {});
  builder.quad(level(20, 20, 4, 4), 4, 4, {});
  return builder;
}

struct Found {
  explicit Found(const PatchSet& set)
      : scene(set),
        lookup(set),
        lattices(set, lookup),
        reach(set.primitives.size(), 0.1),
        at_edges(find_crossings_at_edges(set.primitives, [](std::int32_t) { return 0.1; })),
        seams(set, lattices, reach, at_edges) {}

  int touching(std::int32_t primitive) const {
    return int(std::count_if(scene.patches.begin(), scene.patches.end(),
                             [&](const Patch& patch) { return patch.primitive == primitive && seams.touches(patch); }));
  }

  const PatchSet& scene;
  PatchLookup lookup;
  Lattices lattices;
  std::vector<double> reach;
  std::vector<std::vector<Crossing>> at_edges;
  Seams seams;
};

TEST(Seams, LieWhereCellsOfOtherSizesFollow) {
  PatchScene builder = tiles();
  const Found found(builder.get());
  EXPECT_EQ(found.touching(0), 4) << "not along the tile that continues it";
  EXPECT_EQ(found.touching(1), 0) << "only at a corner";
  EXPECT_EQ(found.touching(2), 8);
  EXPECT_EQ(found.touching(3), 0);
  for (const std::int32_t i : {0, 1, 2}) EXPECT_TRUE(found.seams.has(i)) << i;
  EXPECT_FALSE(found.seams.has(3));
}

TEST(Seams, AreNotBetweenSidesOrPlanes) {
  PatchScene builder;
  const auto floor = level(0, 0, 4, 4);
  builder.quad(floor, 4, 4, {});
  builder.quad({floor[1], floor[0], floor[3], floor[2]}, 4, 8, {});
  builder.quad({{{4, 0, 0}, {4, 0, 4}, {4, 3, 4}, {4, 3, 0}}}, 5, 5, {});
  builder.quad({{{0, 0.01, 4}, {0, 0.01, 8}, {4, 0.01, 8}, {4, 0.01, 4}}}, 8, 8, {});
  const Found found(builder.get());
  for (const std::int32_t i : {0, 1, 2, 3}) EXPECT_FALSE(found.seams.has(i)) << i;
}

TEST(Seams, AreClosedWhereOthersStand) {
  PatchScene builder = tiles();
  builder.quad({{{0, 0, 4}, {2, 0, 4}, {2, 1, 4}, {0, 1, 4}}}, 2, 1, {});
  const Found found(builder.get());
  const PlaneFrame frame = *PlaneFrame::of(builder.get().primitives[0]);
  EXPECT_FALSE(found.seams.is_open(0, frame.to_plane({1, 0, 4})));
  EXPECT_FALSE(found.seams.is_open(0, frame.to_plane({2, 0, 4}))) << "its end";
  EXPECT_TRUE(found.seams.is_open(0, frame.to_plane({3, 0, 4})));
  EXPECT_TRUE(found.seams.is_open(0, frame.to_plane({4, 0, 2})));
}

TEST(SharedPoints, AreOneWithinRoundingOnOnePlane) {
  SharedPoints points(1e-4);
  const Vec3d up(0, 1, 0);
  const std::int32_t first = points.number({1, 0, 1}, up, 1e-5);
  EXPECT_EQ(points.number({1 + 5e-6, 0, 1 - 5e-6}, up, 1e-5), first);
  EXPECT_NE(points.number({1, 0, 1}, -up, 1e-5), first);
  const std::int32_t beside = points.number({1 + 5e-5, 0, 1}, up, 1e-5);
  EXPECT_NE(beside, first);
  EXPECT_EQ(points.number({1 + 4e-5, 0, 1}, up, 1e-4), beside) << "the nearest";
  for (double x = 0; x < 1; x += 0.0317)
    EXPECT_EQ(points.number({x, 0, 2}, up, 1e-5), points.number({x + 9e-6, 0, 2}, up, 1e-5)) << x;
}

}  // namespace
}  // namespace patchlight::test

#include "pipeline/optics/surface/lattices.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

/// A tile of the floor, with a grid of cells of 0.25 x 0.5 m, whose corners begin at corner `turn`.
int add_tile(PatchScene& builder, const Vec3d& at, double width, double depth, int turn) {
  std::array<Vec3d, 4> c{at, at + Vec3d(0, 0, depth), at + Vec3d(width, 0, depth), at + Vec3d(width, 0, 0)};
  std::rotate(c.begin(), c.begin() + turn, c.end());
  const int across = int(std::lround(width / 0.25)), along = int(std::lround(depth / 0.5));
  return builder.quad(c, turn % 2 == 0 ? along : across, turn % 2 == 0 ? across : along, {});
}

/// The patch around a point of the floor; -1: none.
std::int32_t patch_at(const PatchSet& scene, const Vec3d& p) {
  for (std::size_t i = 0; i < scene.patches.size(); ++i)
    if ((scene.patches[i].center - p).length() < 1e-6) return std::int32_t(i);
  return -1;
}

/// Every cell one step beyond the border of every quad is the patch that lies there.
void expect_continued(const PatchSet& scene) {
  const PatchLookup lookup(scene);
  const Lattices lattices(scene, lookup);
  int found = 0;
  for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) {
    const auto& c = scene.primitives[i].corners;
    const int nu = lookup.row(i, 0).cells, nv = lookup.rows(i);
    for (int row = -1; row <= nv; ++row)
      for (int column = -1; column <= nu; ++column) {
        if (row >= 0 && row < nv && column >= 0 && column < nu) continue;
        const Vec3d center = c[0] + (c[1] - c[0]) * ((column + 0.5) / nu) + (c[3] - c[0]) * ((row + 0.5) / nv);
        const std::int32_t beyond = lattices.beyond(i, column, row);
        EXPECT_EQ(beyond, patch_at(scene, center)) << i << " " << column << " " << row;
        found += beyond >= 0;
      }
  }
  EXPECT_GT(found, 10);
}

TEST(Lattices, ContinueGridsWhereverCornersBegin) {
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) {
      PatchScene builder;
      add_tile(builder, {0, 0, 0}, 1, 2, a);
      add_tile(builder, {1, 0, 0}, 1, 2, b);
      add_tile(builder, {0, 0, 2}, 1, 2, b);
      add_tile(builder, {1, 0, 2}, 1, 2, a);
      expect_continued(builder.get());
    }
}

TEST(Lattices, ContinueGridsOfDifferentSize) {
  PatchScene builder;
  add_tile(builder, {0, 0, 0}, 2, 2, 0);
  add_tile(builder, {2, 0, 0}, 1, 1, 1);
  add_tile(builder, {2, 0, 1}, 0.5, 1, 2);
  add_tile(builder, {2.5, 0, 1}, 0.5, 1, 3);
  expect_continued(builder.get());
}

TEST(Lattices, HoldOneFrameForAllTiles) {
  PatchScene builder;
  for (int k = 0; k < 9; ++k) add_tile(builder, {k % 3 - 1.0, 0, k / 3 - 1.0}, 1, 1, k % 4);
  const PatchSet& scene = builder.get();
  const PatchLookup lookup(scene);
  const Lattices lattices(scene, lookup);
  ASSERT_EQ(lattices.quads().size(), 1u);
  EXPECT_EQ(lattices.quads()[0].size(), 9u);
  for (int i = 0; i < 9; ++i) {
    const Lattices::Frame frame = lattices.frame(i);
    EXPECT_EQ(frame.lattice, 0);
    for (const auto& [corner, column, row] :
         {std::tuple(0, 0, 0), {1, lookup.row(i, 0).cells, 0}, {3, 0, lookup.rows(i)}}) {
      const Vec3d p = scene.primitives[i].corners[corner];
      const Lattices::Node node = frame.node(column, row);
      EXPECT_NEAR(double(node.x), (p.z + 1) / 0.5, 1e-9);
      EXPECT_NEAR(double(node.y), (p.x + 1) / 0.25, 1e-9);
    }
  }
}

/// Number of quads that share a lattice with others.
std::size_t joined(const PatchSet& scene) {
  const PatchLookup lookup(scene);
  const Lattices lattices(scene, lookup);
  std::size_t count = 0;
  for (const auto& quads : lattices.quads()) count += quads.size();
  return count;
}

TEST(Lattices, DoNotJoinWhatDoesNotContinue) {
  const auto with = [](const std::array<Vec3d, 4>& other, int nu, int nv) {
    PatchScene builder;
    add_tile(builder, {0, 0, 0}, 1, 1, 0);
    builder.quad(other, nu, nv, {});
    return joined(builder.get());
  };
  EXPECT_EQ(with({{{1, 0, 0}, {1, 0, 1}, {2, 0, 1}, {2, 0, 0}}}, 2, 4), 2u);
  EXPECT_EQ(with({{{1, 0, 0}, {1, 0, 1}, {2, 0, 1}, {2, 0, 0}}}, 3, 4), 0u) << "other cells along the edge";
  EXPECT_EQ(with({{{1, 0, 0}, {1, 0, 1}, {2, 0, 1}, {2, 0, 0}}}, 2, 3), 0u) << "other cells across the edge";
  EXPECT_EQ(with({{{1, 0, 0}, {1, 0, 1}, {1, 1, 1}, {1, 1, 0}}}, 2, 4), 0u) << "a crease";
  EXPECT_EQ(with({{{1, 0, 0}, {2, 0, 0}, {2, 0, 1}, {1, 0, 1}}}, 4, 2), 0u) << "the other side";
  EXPECT_EQ(with({{{1.01, 0, 0}, {1.01, 0, 1}, {2.01, 0, 1}, {2.01, 0, 0}}}, 2, 4), 0u) << "a gap";
  EXPECT_EQ(with({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 2, 4), 0u) << "the same place";
}

TEST(Lattices, EndAtClosedEdges) {
  PatchScene builder;
  add_tile(builder, {0, 0, 0}, 1, 1, 0);
  const int other = add_tile(builder, {1, 0, 0}, 1, 1, 1);
  PatchSet& scene = builder.get();
  const PatchLookup open(scene);
  EXPECT_GE(Lattices(scene, open).beyond(0, 0, 4), 0);
  EXPECT_GE(Lattices(scene, open).beyond(0, 1, 4), 0);
  for (Patch& patch : scene.patches)
    if (patch.primitive == other && patch.center.x < 1.25 && patch.center.z < 0.5) patch.closed = 15;
  const PatchLookup closed(scene);
  EXPECT_EQ(Lattices(scene, closed).beyond(0, 0, 4), -1);
  EXPECT_GE(Lattices(scene, closed).beyond(0, 1, 4), 0);
}

}  // namespace
}  // namespace patchlight

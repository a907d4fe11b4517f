#include "tests/end_to_end/accuracy/places/place.h"

namespace patchlight::test {
namespace {

/// Adds the difference at the points of a rectangle that is parallel to two axes.
void compare(const Place& usual, const Place& fine, const char* node, const Vec3d& from, const Vec3d& along,
             const Vec3d& across, int count_along, int count_across, Difference& difference) {
  const Vec3d normal = (along % across).normalized();
  for (int i = 0; i < count_along; ++i)
    for (int j = 0; j < count_across; ++j) {
      const Vec3d point = from + along * ((i + 0.5) / count_along) + across * ((j + 0.5) / count_across);
      difference.add(usual.at(node, point, normal), fine.at(node, point, normal));
    }
}

/// A house with slats that reach into its front wall, on a ground of 80 m.
void build_slatted_house(Place& place) {
  place.sky = Color(1.0f);
  place.box("ground", {-40, -1, -40}, {40, 0, 40});
  place.box("house", {-5, 0, -5}, {5, 6, 5});
  for (int k = 0; k < 6; ++k) {
    const float x = -4 + 1.2f * float(k);
    place.box("slat", {x, 0.5f, 4.6f}, {x + 0.4f, 6.4f, 5.1f});
  }
}

TEST(Detail, WallsBetweenSlatsAreRightOnAWideGround) {
  Place usual, fine;
  build_slatted_house(usual);
  build_slatted_house(fine);
  usual.solve();
  fine.solve({{"house", 0.01}, {"slat", 0.01}}, 1024);
  Difference wall;
  for (int k = 0; k < 5; ++k) {
    Difference gap;
    compare(usual, fine, "house", {-3.6 + 1.2 * k, 0.5, 5}, {0.8, 0, 0}, {0, 5.5, 0}, 16, 11, gap);
    compare(usual, fine, "house", {-3.6 + 1.2 * k, 0.5, 5}, {0.8, 0, 0}, {0, 5.5, 0}, 16, 11, wall);
    EXPECT_LT(gap.mean(), 0.02) << k;
  }
  EXPECT_LT(wall.mean(), 0.015);
  EXPECT_LT(wall.rms(), 0.03);
}

/// A room with a shelf against its wall, whose books touch each other and the shelf.
void build_library(Place& place) {
  place.box("floor", {-2.5f, -0.2f, -2}, {2.5f, 0, 2});
  place.box("ceiling", {-2.5f, 2.6f, -2}, {2.5f, 2.8f, 2});
  place.box("west", {-2.7f, -0.2f, -2}, {-2.5f, 2.8f, 2});
  place.box("east", {2.5f, -0.2f, -2}, {2.7f, 2.8f, 2});
  place.box("north", {-2.5f, -0.2f, -2.2f}, {2.5f, 2.8f, -2});
  place.box("south", {-2.5f, -0.2f, 2}, {2.5f, 2.8f, 2.2f});
  place.level("lamp", 0, 2.58f, 0, 0.3f, true);
  place.box("side", {-0.62f, 0, -2}, {-0.6f, 1.2f, -1.7f});
  place.box("side", {0.6f, 0, -2}, {0.62f, 1.2f, -1.7f});
  for (int k = 0; k < 4; ++k) {
    const float y = 0.38f * float(k);
    place.box("board", {-0.6f, y, -2}, {0.6f, y + 0.02f, -1.7f});
    float x = -0.6f;
    for (int book = 0; k < 3 && x < 0.2f; ++book) {
      const float next = x + 0.02f + 0.01f * float(book % 3), height = 0.2f + 0.02f * float((7 * book + k) % 5);
      place.box("book", {x, y + 0.02f, -1.97f}, {next, y + 0.02f + height, -1.75f - 0.01f * float(book % 4)});
      x = next;
    }
  }
}

TEST(Detail, AShelfOfBooksIsRight) {
  Place usual, fine;
  build_library(usual);
  build_library(fine);
  usual.solve();
  fine.solve({{"board", 2e-4}, {"book", 2e-4}, {"side", 2e-4}, {"north", 4e-4}}, 1024);
  Difference back, board;
  for (int k = 0; k < 3; ++k) {
    compare(usual, fine, "north", {0.27, 0.38 * k + 0.02, -2}, {0.33, 0, 0}, {0, 0.36, 0}, 12, 12, back);
    compare(usual, fine, "board", {0.27, 0.38 * k + 0.02, -1.7}, {0.33, 0, 0}, {0, 0, -0.3}, 12, 12, board);
  }
  EXPECT_LT(back.mean(), 0.01);
  EXPECT_LT(board.mean(), 0.01);
  EXPECT_LT(back.rms(), 0.03);
  EXPECT_LT(board.rms(), 0.03);
}

/// Stairs of eight steps along a wall, as boxes that stand in each other, on a ground of 30 m.
void build_stairs(Place& place) {
  place.sky = Color(1.0f);
  place.box("ground", {-15, -0.5f, -15}, {15, 0, 15});
  place.box("wall", {-0.3f, 0, -3}, {0, 3, 3});
  for (int k = 0; k < 8; ++k)
    place.box("step", {0, -0.1f, 1.2f - 0.28f * float(k)}, {1, 0.18f * float(k + 1), 1.5f - 0.28f * float(k)});
}

TEST(Detail, StairsAreRight) {
  Place usual, fine;
  build_stairs(usual);
  build_stairs(fine);
  usual.solve();
  fine.solve({{"step", 4e-4}, {"wall", 4e-3}}, 1024);
  Difference treads, risers;
  for (int k = 0; k < 7; ++k) {
    const double y = 0.18 * (k + 1), front = 1.5 - 0.28 * k;
    compare(usual, fine, "step", {0, y, front}, {1, 0, 0}, {0, 0, -0.28}, 20, 8, treads);
    compare(usual, fine, "step", {0, y, front - 0.28}, {1, 0, 0}, {0, 0.18, 0}, 20, 6, risers);
  }
  EXPECT_LT(treads.mean(), 0.01);
  EXPECT_LT(risers.mean(), 0.01);
  EXPECT_LT(treads.rms(), 0.03);
  EXPECT_LT(risers.rms(), 0.03);
}

}  // namespace
}  // namespace patchlight::test

#include "tests/end_to_end/accuracy/places/place.h"

namespace patchlight::test {
namespace {

/// A house of thick walls without a floor, on a ground of a size, with a cupboard and a lamp.
void build_house(Place& place, float ground) {
  place.level("ground", 0, 0, 0, ground / 2);
  place.box("west", {-2.2f, 0, -2.7f}, {-2, 3, 2.7f});
  place.box("east", {2, 0, -2.7f}, {2.2f, 3, 2.7f});
  place.box("north", {-2, 0, -2.7f}, {2, 3, -2.5f});
  place.box("south", {-2, 0, 2.5f}, {2, 3, 2.7f});
  place.box("roof", {-2.2f, 3, -2.7f}, {2.2f, 3.2f, 2.7f});
  place.box("cupboard", {-1.2f, 0, -1.6f}, {-0.3f, 1.1f, -0.8f});
  place.level("lamp", 0, 2.9f, 0, 0.5f, true);
}

TEST(Scales, AHouseIsAsRightOnALandscapeThatIsItsFloor) {
  Place alone, landscape;
  build_house(alone, 6);
  build_house(landscape, 10'000);
  alone.solve();
  landscape.solve();
  EXPECT_LE(landscape.scene.patches.size(), 2 * alone.scene.patches.size());
  Difference floor, wall;
  for (double x = -1.83; x < 2; x += 0.17)
    for (double z = -2.37; z < 2.5; z += 0.19) {
      if (x > -1.3 && x < -0.2 && z > -1.7 && z < -0.7) continue;
      const auto at = [&](const Place& place) { return place.at("ground", {x, 0, z}, {0, 1, 0}); };
      floor.add(at(landscape), at(alone));
    }
  for (double y = 0.05; y < 3; y += 0.11)
    for (double z = -2.37; z < 2.5; z += 0.19) {
      const auto at = [&](const Place& place) { return place.at("west", {-2, y, z}, {1, 0, 0}); };
      wall.add(at(landscape), at(alone));
    }
  EXPECT_LT(floor.mean(), 0.005);
  EXPECT_LT(wall.mean(), 0.005);
  EXPECT_LT(floor.rms(), 0.015);
  EXPECT_LT(wall.rms(), 0.015);
}

/// A hall of 40 x 10 x 24 m with a table, on which a watch lies: a case with a hand above its face, and a strap.
void build_hall(Place& place) {
  place.box("floor", {-20, -0.5f, -12}, {20, 0, 12});
  place.box("ceiling", {-20, 10, -12}, {20, 10.5f, 12});
  place.box("west", {-20.5f, 0, -12}, {-20, 10, 12});
  place.box("east", {20, 0, -12}, {20.5f, 10, 12});
  place.box("north", {-20, 0, -12.5f}, {20, 10, -12});
  place.box("south", {-20, 0, 12}, {20, 10, 12.5f});
  for (int k = 0; k < 4; ++k) place.level("lamp", float(-15 + 10 * k), 9.9f, 0, 1.5f, true);
  place.box("table", {-0.8f, 0.72f, -0.4f}, {0.8f, 0.75f, 0.4f});
  place.box("case", {-0.02f, 0.75f, -0.02f}, {0.02f, 0.757f, 0.02f});
  place.box("hand", {-0.001f, 0.7575f, -0.013f}, {0.001f, 0.7578f, 0});
  place.box("strap", {-0.008f, 0.75f, 0.0205f}, {0.008f, 0.753f, 0.06f});
}

TEST(Scales, AWatchInAHallIsAsRightAsByItself) {
  Place usual, fine;
  build_hall(usual);
  build_hall(fine);
  usual.solve();
  fine.solve({{"case", 2e-7}, {"hand", 2e-7}, {"strap", 2e-7}}, 2048);
  EXPECT_LE(usual.scene.patches.size(), 2u * 8000u);
  Difference face, side;
  for (double x = -0.0188; x < 0.02; x += 0.0021)
    for (double z = -0.0188; z < 0.02; z += 0.0023) {
      if (std::abs(x) < 0.0016 && z > -0.0136 && z < 0.0006) continue;
      const auto at = [&](const Place& place) { return place.at("case", {x, 0.757, z}, {0, 1, 0}); };
      face.add(at(usual), at(fine));
    }
  for (double x = -0.0075; x < 0.008; x += 0.0011)
    for (double z = 0.0215; z < 0.06; z += 0.0023) {
      const auto at = [&](const Place& place) { return place.at("strap", {x, 0.753, z}, {0, 1, 0}); };
      side.add(at(usual), at(fine));
    }
  EXPECT_LT(face.mean(), 0.005);
  EXPECT_LT(side.mean(), 0.005);
  EXPECT_LT(face.rms(), 0.02);
  EXPECT_LT(side.rms(), 0.02);
}

}  // namespace
}  // namespace patchlight::test

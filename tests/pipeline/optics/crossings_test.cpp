#include "pipeline/optics/cuts/crossings.h"

#include <gtest/gtest.h>

#include <numbers>

#include "pipeline/optics/cuts/cell_cutter.h"

namespace patchlight {
namespace {

Primitive quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  Primitive p;
  p.corners = {a, b, c, d};
  return p;
}

/// A square of 4 m in the plane y = 0, lit from above; its PlaneFrame has x along z and y along x, from (-2, -2).
Primitive ground() {
  return quad({-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2});
}

/// A wall across the ground at x, from y = low.
Primitive wall(double x, double low, double high = 3) {
  return quad({x, low, -1}, {x, low, 1}, {x, high, 1}, {x, high, -1});
}

std::vector<Crossing> crossings(std::vector<Primitive> others, double reach = 0.01) {
  others.insert(others.begin(), ground());
  return find_crossings(others, [&](std::int32_t i) { return i == 0 ? reach : -1.0; })[0];
}

TEST(Crossings, AreWhereSurfacesStandOnAPlaneOrGoThroughIt) {
  for (const double low : {-1.0, -1e-9, 0.0, 0.005}) {
    const auto found = crossings({wall(0.5, low)});
    ASSERT_EQ(found.size(), low < -1e-6 ? 2u : 1u) << "one for each triangle that goes through";
    double length = 0;
    for (const Crossing& crossing : found) {
      EXPECT_NEAR(crossing.from.y, 2.5, 1e-9);
      EXPECT_NEAR(crossing.to.y, 2.5, 1e-9);
      EXPECT_NEAR(crossing.height, low > 0 ? low : 0.0, 1e-9);
      EXPECT_NEAR(crossing.extent, 2, 1e-9);
      EXPECT_NEAR(crossing.relief, 3, 1e-9);
      length += (crossing.to - crossing.from).length();
    }
    EXPECT_NEAR(length, 2, 1e-9);
  }
}

TEST(Crossings, AreNotOfSurfacesBehindAbovePastOrInThePlane) {
  EXPECT_TRUE(crossings({wall(0.5, 0.02)}).empty()) << "beyond the reach";
  EXPECT_TRUE(crossings({wall(0.5, -3, 0)}).empty()) << "behind";
  EXPECT_TRUE(crossings({wall(2.5, 0)}).empty()) << "past its edge";
  EXPECT_TRUE(crossings({wall(2, 0)}).empty()) << "along its edge";
  EXPECT_TRUE(crossings({quad({0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0})}).empty()) << "in the plane";
  Primitive masked = wall(0.5, 0);
  masked.mask = 0;
  EXPECT_TRUE(crossings({masked}).empty());
}

TEST(Crossings, AtEdgesAreOnlyThere) {
  const auto at_edges = [](const Primitive& other) {
    return find_crossings_at_edges({ground(), other}, [](std::int32_t i) { return i == 0 ? 0.01 : -1.0; })[0];
  };
  for (const double low : {-1.0, 0.0, 0.005}) {
    double length = 0;
    for (const Crossing& crossing : at_edges(wall(2, low))) {
      EXPECT_NEAR(crossing.from.y, 4, 1e-9);
      EXPECT_NEAR(crossing.to.y, 4, 1e-9);
      length += (crossing.to - crossing.from).length();
    }
    EXPECT_NEAR(length, 2, 1e-9) << low;
  }
  EXPECT_TRUE(at_edges(wall(0.5, 0)).empty());
  EXPECT_TRUE(at_edges(wall(2.01, 0)).empty());
  EXPECT_TRUE(at_edges(wall(2, -3, 0)).empty()) << "behind";
}

TEST(Crossings, OfAPanelAboveThePlaneAreItsEdges) {
  const auto found = crossings({quad({-1, 0.005, -1}, {-1, 0.005, 1}, {1, 0.005, 1}, {1, 0.005, -1})});
  ASSERT_EQ(found.size(), 4u);
  for (const Crossing& crossing : found) EXPECT_NEAR(crossing.extent, std::sqrt(8.0), 1e-9) << "connected";
}

TEST(Crossings, OfBothSidesOfASurfaceCountOnce) {
  std::vector<Primitive> sides{wall(0.5, 0), quad({0.5, 0, 1}, {0.5, 0, -1}, {0.5, 3, -1}, {0.5, 3, 1})};
  sides[0].back = 2;  // behind the ground
  sides[1].back = 1;
  EXPECT_EQ(crossings(sides).size(), 1u);
}

TEST(Crossings, DoNotDependOnScaleOrPlace) {
  for (const double scale : {1e-3, 1.0, 1e3})
    for (const double shift : {0.0, 1e4}) {
      std::vector<Primitive> scene{ground(), wall(0.5, 0), wall(-0.5, -1)};
      for (Primitive& p : scene)
        for (Vec3d& c : p.corners) c = Vec3d(Vec3f((c + Vec3d(shift)) * scale));  // as files round them
      const auto found = find_crossings(scene, [&](std::int32_t i) { return i == 0 ? 0.0 : -1.0; })[0];
      ASSERT_EQ(found.size(), 3u) << scale << " " << shift;
      for (const Crossing& crossing : found)
        EXPECT_NEAR(crossing.from.y, crossing.to.y, 2e-3 * scale) << scale << " " << shift;
    }
}

const Polygon kCell{{0, 0}, {1, 0}, {1, 1}, {0, 1}};

TEST(CellCutter, CutsNothingWithoutCrossings) {
  const std::vector<Crossing> none;
  const CellParts parts = CellCutter(none, 0.1, 1e-7).cut(kCell);
  EXPECT_TRUE(parts.cuts.empty());
  EXPECT_EQ(parts.parts.at(0), kCell);
}

/// Checks that parts are convex, cover the cell, and are named once by the tree of lines.
void expect_parts_of_the_cell(const CellParts& cell) {
  double area = 0;
  for (const Polygon& part : cell.parts) {
    EXPECT_LE(part.size(), std::size_t(CellCutter::kMostCorners));
    EXPECT_GT(area_of(part), 0);
    for (std::size_t k = 0; k < part.size(); ++k)
      EXPECT_GE(side_of(part[k], part[(k + 1) % part.size()], part[(k + 2) % part.size()]), -1e-12);
    area += area_of(part);
  }
  EXPECT_NEAR(area, 1, 1e-12);
  EXPECT_EQ(cell.cuts.size() + 1, cell.parts.size());
  std::vector<int> named(cell.parts.size());
  for (const auto& line : cell.cuts)
    for (const std::int32_t side : line.sides)
      if (side < 0) ++named.at(std::size_t(~side));
  for (const int count : named) EXPECT_EQ(count, 1);
}

TEST(CellCutter, NoPartLiesOnBothSidesOfACrossing) {
  std::vector<Crossing> tower;  // a round tower of 500 facets, of which the cell sees an arc
  constexpr int kFacets = 500;
  const auto at = [](int k) {
    const double angle = 2 * std::numbers::pi * k / kFacets;
    return Vec2d(-0.4 + std::cos(angle), 0.3 + std::sin(angle));
  };
  for (int k = 0; k < kFacets; ++k) tower.push_back({at(k), at(k + 1), 0, 2.8});
  const std::vector<std::vector<Crossing>> cases{{{{0.3, -1}, {0.3, 2}, 0, 3}},
                                                 {{{0.3, 0.2}, {0.6, 0.8}, 0, 3}},
                                                 {{{0.2, 0.2}, {0.8, 0.2}, 0, 1},
                                                  {{0.8, 0.2}, {0.8, 0.7}, 0, 1},
                                                  {{0.8, 0.7}, {0.2, 0.7}, 0, 1},
                                                  {{0.2, 0.7}, {0.2, 0.2}, 0, 1}},
                                                 tower};
  for (const auto& crossings : cases) {
    const CellParts cell = CellCutter(crossings, 0.1, 1e-7).cut(kCell);
    EXPECT_GE(cell.cuts.size(), 1u);
    expect_parts_of_the_cell(cell);
    for (const Polygon& part : cell.parts)
      for (const Crossing& crossing : crossings)
        for (const double t : {0.1, 0.5, 0.9}) {  // no point of a crossing lies inside of a part
          const Vec2d point = crossing.from + (crossing.to - crossing.from) * t;
          double inside = 1;
          for (std::size_t k = 0; k < part.size(); ++k) {
            const Vec2d &a = part[k], &b = part[(k + 1) % part.size()];
            inside = std::min(inside, side_of(a, b, point) / (b - a).length());
          }
          EXPECT_LE(inside, 1.1e-5);
        }
  }
}

TEST(CellCutter, LeavesOutWhatIsSmallHighOrOnTheEdge) {
  const Crossing line{{0.3, 0.4}, {0.3, 0.5}, 0, 0.1};
  for (const auto& [extent, height, parts] :
       {std::tuple(0.1, 0.0, 1u), {0.3, 0.0, 2u}, {0.3, 0.2, 2u}, {0.3, 0.3, 1u}}) {
    Crossing crossing = line;
    crossing.extent = extent;
    crossing.height = height;
    EXPECT_EQ(CellCutter(std::vector{crossing}, 0.25, 1e-7).cut(kCell).parts.size(), parts) << extent << " " << height;
  }
  const std::vector<Crossing> edge{{{1, -1}, {1, 0.7}, 0, 3}};
  EXPECT_TRUE(CellCutter(edge, 0.25, 1e-7).cut(kCell).cuts.empty());
  EXPECT_TRUE(CellCutter(edge, 0.25, 1e-7).is_closed({1, 0}, {1, 1}));
  EXPECT_FALSE(CellCutter(edge, 0.25, 1e-7).is_closed({0, 0}, {0, 1}));
  EXPECT_FALSE(CellCutter(edge, 0.25, 1e-7).is_closed({0, 0}, {1, 0}));
}

}  // namespace
}  // namespace patchlight

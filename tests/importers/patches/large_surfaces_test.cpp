#include "importers/patches/large_surfaces.h"

#include <gtest/gtest.h>

#include <cmath>

#include "importers/patches/patch_areas.h"

namespace patchlight::test {
namespace {

Primitive quad(const std::array<Vec3d, 4>& corners) {
  Primitive primitive;
  primitive.corners = corners;
  for (std::int32_t k = 0; k < 4; ++k) primitive.smooth_vertices[k] = k;
  return primitive;
}

/// A horizontal square that faces up, around a point.
Primitive level_square(double side, const Vec3d& at) {
  const double h = 0.5 * side;
  return quad({at + Vec3d(-h, 0, h), at + Vec3d(h, 0, h), at + Vec3d(h, 0, -h), at + Vec3d(-h, 0, -h)});
}

/// A ground of `extent` with a hut of 2 m at (x, 0, 0), which is `height` above it.
PrimitiveList ground_with_hut(double extent, double x, double height = 0) {
  PrimitiveList list;
  list.primitives.push_back(level_square(extent, Vec3d(0.0)));
  const std::array<Vec3d, 5> foot{Vec3d(-1, 0, 1), Vec3d(1, 0, 1), Vec3d(1, 0, -1), Vec3d(-1, 0, -1), Vec3d(-1, 0, 1)};
  const Vec3d at(x, height, 0), up(0, 2, 0);
  for (int k = 0; k < 4; ++k)
    list.primitives.push_back(quad({at + foot[k], at + foot[k + 1], at + foot[k + 1] + up, at + foot[k] + up}));
  return list;
}

struct Divided {
  explicit Divided(PrimitiveList primitives, const ImportConfig& config = {}, std::vector<SurfaceMaterial> used = {{}})
      : list(std::move(primitives)), materials(std::move(used)) {
    const std::vector<double> areas = choose_patch_areas(list.primitives, materials, config);
    targets = divide_large_surfaces(materials, areas, config, list);
  }

  /// Size of the patches of the ground at (x, 0, z), m.
  double size_at(double x, double z) const {
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const auto& c = list.primitives[i].corners;
      if (c[2].y != 0 || x < c[0].x || x >= c[1].x || z >= c[0].z || z < c[3].z) continue;
      const QuadGrid grid =
          targets[i].grid.columns > 0 ? targets[i].grid : quad_grid(list.primitives[i], targets[i].area);
      return (c[1].x - c[0].x) / grid.columns;
    }
    return 0;
  }

  double area_of_ground() const {
    double area = 0;
    for (const Primitive& p : list.primitives) area += p.corners[2].y == 0 ? primitive_area(p) : 0;
    return area;
  }

  double patches() const {
    double count = 0;
    for (std::size_t i = 0; i < targets.size(); ++i)
      count += targets[i].grid.columns > 0 ? double(targets[i].grid.columns) * targets[i].grid.rows
                                           : patch_count(list.primitives[i], targets[i].area);
    return count;
  }

  PrimitiveList list;
  std::vector<SurfaceMaterial> materials;
  std::vector<PatchTarget> targets;
};

TEST(LargeSurfaces, HaveSmallPatchesBesideSmallThings) {
  for (const double extent : {1'000.0, 10'000.0, 100'000.0})
    for (const double x : {0.0, 0.3 * extent}) {
      const Divided divided(ground_with_hut(extent, x));
      const double of_hut = std::sqrt(16.0 / 8000);
      for (const double beyond : {-0.9, 0.0, 0.9, 1.01})
        EXPECT_LT(divided.size_at(x + beyond, 0.3), 2.5 * of_hut) << extent;
      for (double distance = 2; distance < 0.15 * extent; distance *= 1.7)
        EXPECT_LT(divided.size_at(x + distance, 0.1), 3 * (of_hut + 0.3 * (distance - 1))) << extent;
      EXPECT_NEAR(divided.area_of_ground() / (extent * extent), 1, 1e-9);
      EXPECT_LT(divided.patches(), 16'000) << extent;
    }
}

TEST(LargeSurfaces, StayWholeWithoutSmallThings) {
  EXPECT_EQ(Divided(ground_with_hut(20, 0)).list.primitives.size(), 5u);
  EXPECT_EQ(Divided(ground_with_hut(10'000, 0, 30'000)).list.primitives.size(), 5u);
  EXPECT_EQ(Divided(ground_with_hut(10'000, 0, -3)).list.primitives.size(), 5u) << "behind";
}

TEST(LargeSurfaces, AreNotThoseThatAreSmallerThanTheirPatchesMayBe) {
  PrimitiveList list;
  list.primitives = {level_square(0.006, Vec3d(0.0)), quad({Vec3d(0, 0, 0.01), Vec3d(0.001, 0, 0.01),
                                                            Vec3d(0.001, 0.001, 0.01), Vec3d(0, 0.001, 0.01)})};
  list.primitives[1].smooth_vertices = {4, 5, 6, 7};
  const std::vector<PatchTarget> targets = divide_large_surfaces({{}}, {0.15, 1e-4}, {}, list);
  ASSERT_EQ(targets.size(), 2u);
  for (const PatchTarget& target : targets) EXPECT_LE(target.grid.columns * target.grid.rows, 1);
}

TEST(LargeSurfaces, StayWholeWhereTheJobOrLightSaysSo) {
  ImportConfig config;
  config.patch_area = 1e6;
  EXPECT_EQ(Divided(ground_with_hut(10'000, 0), config).list.primitives.size(), 5u);
  PrimitiveList list = ground_with_hut(10'000, 0);
  list.primitives[0].light_group = 0;
  EXPECT_EQ(Divided(list).list.primitives.size(), 5u);
  list = ground_with_hut(10'000, 0);
  list.primitives[0].material = 1;
  std::vector<SurfaceMaterial> materials(2);
  materials[1].specular = Color(0.5f);
  EXPECT_EQ(Divided(list, {}, materials).list.primitives.size(), 5u);
  materials[1] = {};
  materials[1].patch_area = 1e4;
  EXPECT_EQ(Divided(list, {}, materials).list.primitives.size(), 5u);
}

TEST(LargeSurfaces, KeepTheirTextureCoordinatesAndBacks) {
  PrimitiveList list = ground_with_hut(10'000, 3);
  Primitive back = list.primitives[0];
  for (int k = 0; k < 4; ++k) back.corners[k] = list.primitives[0].corners[std::array{1, 0, 3, 2}[k]];
  list.primitives.insert(list.primitives.begin() + 1, back);
  list.primitives[0].back = 1;
  list.primitives[1].back = 0;
  list.primitives[0].shader = list.primitives[1].shader = 0;
  const Divided divided(list);
  ASSERT_GT(divided.list.primitives.size(), 100u);
  ASSERT_EQ(divided.list.texcoords.size(), divided.list.primitives.size());
  for (std::size_t i = 0; i + 4 < divided.list.primitives.size(); i += 2) {
    const Primitive &front = divided.list.primitives[i], &other = divided.list.primitives[i + 1];
    EXPECT_EQ(front.back, std::int32_t(i) + 1);
    EXPECT_EQ(other.back, std::int32_t(i));
    for (int k = 0; k < 4; ++k) {
      const int in_front = std::array{1, 0, 3, 2}[k];
      EXPECT_EQ(other.corners[k], front.corners[in_front]);
      EXPECT_NEAR(divided.list.texcoords[i][k].x, front.corners[k].x / 10'000 + 0.5, 1e-6);
      EXPECT_NEAR(divided.list.texcoords[i][k].y, 0.5 - front.corners[k].z / 10'000, 1e-6);
      EXPECT_NEAR(divided.list.texcoords[i + 1][k].x, 0.5 - other.corners[k].x / 10'000, 1e-6);
    }
  }
}

TEST(LargeSurfaces, KeepToTheLimitOfPatches) {
  ImportConfig config;
  for (const std::int64_t limit : {100, 3000, 9500, 12'000}) {
    config.max_patches = limit;
    EXPECT_LE(Divided(ground_with_hut(10'000, 0), config).patches(), double(limit));
  }
}

TEST(LargeSurfaces, MayBeTriangles) {
  PrimitiveList list = ground_with_hut(10'000, 800);
  auto& c = list.primitives[0].corners;
  c[2] = c[3] = (c[2] + c[3]) * 0.5;
  list.primitives[0].smooth_vertices[3] = list.primitives[0].smooth_vertices[2];
  const Divided divided(list);
  EXPECT_NEAR(divided.area_of_ground() / 5e7, 1, 1e-9);
  int tips = 0;
  for (const Primitive& p : divided.list.primitives) {
    EXPECT_EQ(p.is_triangle(), p.smooth_vertices[2] == p.smooth_vertices[3]);
    tips += p.is_triangle();
  }
  EXPECT_GE(tips, 1);
}

TEST(LargeSurfaces, MayBeRegions) {
  PrimitiveList list = ground_with_hut(1'000, 0);
  Region octagon;
  std::array<Vec2d, 8> corners;
  for (std::size_t k = 0; k < 8; ++k)
    corners[k] = Vec2d(0.5, 0.5) + Vec2d(std::cos(kPi / 4 * double(k)), std::sin(kPi / 4 * double(k))) * 0.5;
  for (std::size_t k = 0; k < 8; ++k) octagon.edges.push_back({corners[k], corners[(k + 1) % 8]});
  for (std::size_t k = 1; k < 6; k += 2)
    octagon.pieces.push_back({corners[0], corners[k], corners[k + 1], corners[k + 2]});
  list.primitives[0].region = std::make_shared<const Region>(octagon);
  const double area = primitive_area(list.primitives[0]);
  const Divided divided(list);
  EXPECT_GT(divided.list.primitives.size(), 100u);
  EXPECT_LT(divided.size_at(1.01, 0.3), 0.12);
  EXPECT_NEAR(divided.area_of_ground() / area, 1, 1e-6);
  double outline = 0;
  int whole = 0, partial = 0;
  for (const Primitive& p : divided.list.primitives) {
    if (p.corners[2].y != 0) continue;
    ++(p.region ? partial : whole);
    for (const auto& [from, to] : p.region ? p.region->edges : octagon.edges)
      outline += p.region ? (position_at(p.corners, to.x, to.y) - position_at(p.corners, from.x, from.y)).length() : 0;
  }
  EXPECT_NEAR(outline, 8 * 1'000 * std::sin(kPi / 8), 1e-3);
  EXPECT_GT(whole, 10);
  EXPECT_GT(partial, 4);
}

TEST(LargeSurfaces, AreCoarserWhereManySmallThingsStand) {
  PrimitiveList list;
  list.primitives.push_back(level_square(10'000, Vec3d(0.0)));
  for (int k = 0; k < 400; ++k) {
    const Vec3d at(-4000 + k % 20 * 400, 1, -4000 + k / 20 * 400);
    list.primitives.push_back(level_square(0.2, at));
  }
  EXPECT_LT(Divided(list).patches(), 3 * 8000);
  list.primitives.resize(11);
  EXPECT_GT(Divided(list).list.primitives.size(), 111u);
}

}  // namespace
}  // namespace patchlight::test

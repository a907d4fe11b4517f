#include "importers/patches/facet_clusters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "importers/patches/patch_builder.h"

namespace patchlight::test {
namespace {

/// A surface over the unit square in `along` x `across` quads.
PrimitiveList surface(int along, int across, const std::function<Vec3d(double, double)>& at) {
  PrimitiveList list;
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < along; ++i) {
      const auto corner = [&](int x, int y) { return at(double(x) / along, double(y) / across); };
      Primitive& p = list.primitives.emplace_back();
      p.corners = {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
    }
  return list;
}

/// A pole of 1 m around y, 10 cm thick.
Vec3d on_pole(double x, double y) {
  const double angle = 2 * kPi * std::fmod(x, 1.0);
  return {0.05 * std::cos(angle), y, -0.05 * std::sin(angle)};
}

/// Hills of 1 m2.
Vec3d on_terrain(double x, double y) {
  return {x, 0.05 * std::sin(9 * x) * std::cos(7 * y) + 0.01 * std::sin(41 * x + 29 * y), -y};
}

struct Clustered {
  Clustered(PrimitiveList primitives, double target, SurfaceMaterial material = {}) : list(std::move(primitives)) {
    std::vector<PatchTarget> targets(list.primitives.size(), {target, {}});
    clusters = cluster_facets({material}, targets, list);
    patches = build_patches(list.primitives, {material}, targets, clusters);
  }

  PrimitiveList list;
  std::vector<FacetCluster> clusters;
  std::vector<Patch> patches;
};

double total_area(const std::vector<Patch>& patches) {
  double sum = 0;
  for (const Patch& patch : patches) sum += patch.area;
  return sum;
}

TEST(FacetClusters, TheirNumberFollowsFromTheTargetAndNotFromTheFacets) {
  for (const auto& at : {on_pole, on_terrain}) {
    const Clustered coarse(surface(40, 40, at), 0.01), fine(surface(80, 80, at), 0.01);
    const double area = total_area(coarse.patches);
    EXPECT_EQ(coarse.patches.size(), coarse.clusters.size()) << "all facets are in clusters";
    EXPECT_GT(double(coarse.patches.size()), 0.7 * area / 0.01);
    EXPECT_LT(double(coarse.patches.size()), 3 * area / 0.01);
    EXPECT_NEAR(double(fine.patches.size()) / double(coarse.patches.size()), 1, 0.15);
    EXPECT_NEAR(total_area(fine.patches) / area, 1, 0.01);
  }
}

TEST(FacetClusters, FaceOneWayUnlessTheyAreSmall) {
  const Clustered pole(surface(40, 40, on_pole), 0.05);
  for (const FacetCluster& cluster : pole.clusters) {
    Vec3d sum(0.0);
    double area = 0;
    for (std::int32_t i = cluster.first; i < cluster.first + cluster.count; ++i) {
      const auto& c = pole.list.primitives[i].corners;
      const Vec3d of_facet = (c[2] - c[0]) % (c[3] - c[1]);
      sum += of_facet;
      area += of_facet.length();
    }
    EXPECT_GT(sum.length(), 0.8 * area);
  }
  EXPECT_GT(pole.clusters.size(), 4u);
  EXPECT_EQ(Clustered(surface(40, 40, on_pole), 20).clusters.size(), 1u) << "far smaller than patches of its scale";
}

TEST(FacetClusters, KeepBothSidesOfFacetsTogether) {
  PrimitiveList list, fronts = surface(20, 20, on_terrain);
  for (const Primitive& front : fronts.primitives) {
    const auto index = std::int32_t(list.primitives.size());
    list.primitives.push_back(front);
    list.primitives.push_back(front);
    const auto& c = front.corners;
    list.primitives[index + 1].corners = {c[1], c[0], c[3], c[2]};
    list.primitives[index].back = index + 1;
    list.primitives[index + 1].back = index;
    list.normals.resize(list.primitives.size(), kFlatNormals);
    list.normals[index][0].x = float(index);
  }
  const Clustered both(list, 0.05);
  ASSERT_GE(both.clusters.size(), 20u);
  ASSERT_EQ(both.clusters.size() % 2, 0u);
  for (std::size_t i = 0; i < both.list.primitives.size(); ++i) {
    const Primitive& p = both.list.primitives[i];
    ASSERT_GE(p.back, 0);
    const Primitive& back = both.list.primitives[p.back];
    EXPECT_EQ(back.back, std::int32_t(i));
    EXPECT_EQ(p.corners[0], back.corners[1]);
  }
  for (const FacetCluster& cluster : both.clusters)
    for (std::int32_t k = 0; k < cluster.count; ++k)
      EXPECT_EQ(both.list.primitives[cluster.first + k].back, both.list.primitives[cluster.first].back + k);
  std::set<float> marks;
  for (std::size_t i = 0; i < both.list.primitives.size(); ++i) marks.insert(both.list.normals[i][0].x);
  EXPECT_EQ(marks.size(), 400u) << "values at corners move with their primitives";
}

TEST(FacetClusters, AreConnected) {
  // Two sheets, one above the other and facing the same way, closer than a cluster is wide.
  PrimitiveList list = surface(20, 20, on_terrain);
  for (const Primitive& p :
       surface(20, 20, [](double x, double y) { return on_terrain(x, y) - Vec3d(0, 0.1, 0); }).primitives)
    list.primitives.push_back(p);
  const Clustered sheets(list, 0.1);
  ASSERT_GE(sheets.clusters.size(), 10u);
  for (const FacetCluster& cluster : sheets.clusters) {
    const auto height = [&](std::int32_t k) {
      const Vec3d& c = sheets.list.primitives[k].corners[0];
      return c.y - on_terrain(c.x, -c.z).y;
    };
    for (std::int32_t k = cluster.first; k < cluster.first + cluster.count; ++k)
      EXPECT_NEAR(height(k), height(cluster.first), 0.05);
  }
}

TEST(FacetClusters, AreNotOfLampsMetalsLargeFacetsAndBoxes) {
  PrimitiveList lamp = surface(20, 20, on_terrain);
  for (Primitive& p : lamp.primitives) p.light_group = 0;
  EXPECT_TRUE(Clustered(lamp, 0.05).clusters.empty());
  SurfaceMaterial metal;
  metal.specular = Color(0.9f);
  EXPECT_TRUE(Clustered(surface(20, 20, on_terrain), 0.05, metal).clusters.empty());
  EXPECT_TRUE(Clustered(surface(20, 20, on_terrain), 0.002).clusters.empty());
  EXPECT_TRUE(Clustered(surface(4, 4, on_terrain), 5).clusters.empty());
  EXPECT_FALSE(Clustered(surface(20, 20, on_terrain), 0.05).clusters.empty());
}

}  // namespace
}  // namespace patchlight::test

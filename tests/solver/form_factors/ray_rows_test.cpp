#include "solver/form_factors/ray_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "pipeline/optics/sampling/sobol.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

Transport cast(const PatchSet& scene, int rays) {
  const RayScene ray_scene(scene);
  Progress progress({"test", true, ""});
  Transport transport;
  RayRows(scene, ray_scene, scene.patches, Elements(scene), 1, true).cast(rays, transport, progress);
  return transport;
}

/// Mean form factor from `rows` patches of equal area, from `first` on, to `patches` patches from `to` on.
double form_factor(const Transport& transport, int first, int rows, int to, int patches) {
  double sum = 0;
  for (int sample_set = 2 * first; sample_set < 2 * (first + rows); ++sample_set)
    for (std::uint64_t k = transport.starts[sample_set]; k < transport.starts[sample_set + 1]; ++k)
      if (transport.columns[k] >= to && transport.columns[k] < to + patches) sum += transport.hit_weights[sample_set];
  return sum / (2 * rows);
}

TEST(DirectionTable, HasTheCosineDensity) {
  const DirectionTable table(1024);
  double height = 0, square = 0, across = 0;
  for (int k = 0; k < table.count(); ++k) {
    const Vec3f d = cosine_direction(unit_float(table.x[k]), unit_float(table.y[k]));
    height += d.z / 1024;
    square += d.z * d.z / 1024;
    across += d.x / 1024;
  }
  EXPECT_NEAR(height, 2.0 / 3, 2e-3);
  EXPECT_NEAR(square, 0.5, 2e-3);
  EXPECT_NEAR(across, 0, 2e-3);
}

TEST(DirectionTable, IsStratifiedAfterAnyShift) {
  const DirectionTable table(64);
  for (const std::uint32_t index : {0u, 1u, 5u}) {
    const std::array<std::uint32_t, 4> shift = table.block(index);
    for (int bits = 0; bits <= 6; ++bits) {  // a (0,6,2)-net: 2^bits columns, 2^(6 - bits) rows
      std::set<std::pair<std::uint32_t, std::uint32_t>> cells;
      for (int k = 0; k < 64; ++k)
        cells.insert(
            {std::uint64_t(table.x[k] ^ shift[0]) >> (32 - bits), std::uint64_t(table.y[k] ^ shift[1]) >> (26 + bits)});
      EXPECT_EQ(cells.size(), 64u) << "block " << index << ", " << bits << " bits of x";
    }
  }
}

TEST(RayRows, HaveTwoSampleSetsOfEqualSize) {
  PatchScene builder;
  builder.room(1, 3, {});
  const Transport transport = cast(builder.get(), 100);
  EXPECT_EQ(transport.starts.size(), 2 * builder.get().patches.size() + 1);
  for (std::size_t k = 1; k < transport.starts.size(); ++k)
    EXPECT_EQ(transport.starts[k] - transport.starts[k - 1], 64u) << "128 rays a row, a multiple of 32";
}

TEST(RayRows, CastMoreBlocksWhereMostRaysHitNothing) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 1, 1, {});
  builder.quad({{{0, 3, 0}, {1, 3, 0}, {1, 3, 1}, {0, 3, 1}}}, 1, 1, {});
  const Transport transport = cast(builder.get(), 1 << 12);
  EXPECT_EQ(transport.hit_weights[0], 1.0f / (8 << 11)) << "eight blocks";
  EXPECT_NEAR(form_factor(transport, 0, 1, 1, 1), 0.032971, 3e-4);  // Howell 2010, C-11
}

TEST(RayRows, AreThoseOfTheVisiblePartOfAPatch) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 1, 1, {});  // a floor, and a block on its part left of x
  const double x = 0.3;
  builder.quad({{{x, 0, 0}, {x, 1, 0}, {x, 1, 1}, {x, 0, 1}}}, 1, 1, {});
  builder.quad({{{-1, 1, 0}, {-1, 1, 1}, {x, 1, 1}, {x, 1, 0}}}, 1, 1, {});
  builder.quad({{{-1, 0, 1}, {x, 0, 1}, {x, 1, 1}, {-1, 1, 1}}}, 1, 1, {});
  builder.quad({{{-1, 0, 0}, {-1, 1, 0}, {x, 1, 0}, {x, 0, 0}}}, 1, 1, {});
  builder.quad({{{-1, 0, 0}, {-1, 0, 1}, {-1, 1, 1}, {-1, 1, 0}}}, 1, 1, {});
  const Transport transport = cast(builder.get(), 1 << 13);
  ASSERT_EQ(transport.visible_fractions.size(), 2 * builder.get().patches.size());
  EXPECT_NEAR(transport.visible_fractions[0], 1 - x, 0.01);
  EXPECT_NEAR(form_factor(transport, 0, 1, 1, 1), 0.24842, 0.004) << "rectangles that share an edge: Howell 2010, C-14";
}

TEST(RayRows, InAClosedRoomHitOnlyPatchesOfOtherPlanes) {
  PatchScene builder;
  builder.room(1, 4, {});
  const Transport transport = cast(builder.get(), 512);
  EXPECT_EQ(form_factor(transport, 0, 96, 96, 1), 0) << "no ray leaves the room";
  for (int wall = 0; wall < 6; ++wall) EXPECT_EQ(form_factor(transport, 16 * wall, 16, 16 * wall, 16), 0);
}

TEST(RayRows, LeaveNoClosedRoom) {
  for (const double half : {0.7, 1.0, 1.37}) {
    PatchScene builder;
    builder.room(half, 4, {});
    PatchSet& scene = builder.get();
    scene.environment.emplace();
    scene.environment->texels.assign(1, Color(1.0f));
    scene.environment->cells.assign(1, Color(1.0f));
    const Transport transport = cast(scene, 1 << 14);
    const auto sky = std::int32_t(scene.patches.size());
    EXPECT_EQ(std::count(transport.columns.begin(), transport.columns.end(), sky), 0) << half;
  }
}

TEST(RayRows, AgreeWithTheClosedFormOfParallelSquares) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 3, 3, {});
  builder.quad({{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}}, 5, 5, {});
  const Transport transport = cast(builder.get(), 1 << 14);
  EXPECT_NEAR(form_factor(transport, 0, 9, 9, 25), 0.199824895698387, 1e-3);
  EXPECT_NEAR(form_factor(transport, 9, 25, 0, 9), 0.199824895698387, 1e-3);
}

TEST(RayRows, DoNotCountHitsOfUnlitBacks) {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 1, 1, {});
  builder.quad({{{-9, 1, -9}, {-9, 1, 9}, {9, 1, 9}, {9, 1, -9}}}, 1, 1, {});  // lit upwards
  EXPECT_EQ(form_factor(cast(builder.get(), 256), 0, 1, 1, 1), 0);
}

/// Sum of a row's specular weights.
Vec3d mirrored(const Transport& transport, int row) {
  Vec3d sum(0.0);
  for (const auto& m : transport.mirrored)
    if (m.row == row) sum += Vec3d(m.weight) * 0.5;
  return sum;
}

PatchScene before_mirror(const Color& specular, float roughness) {
  PatchScene builder;
  builder.get().materials.push_back({"mirror", specular, roughness});
  builder.room(1, 1, {0.5f, 0.0f});
  builder.quad({{{-0.5, -0.5, 0.9}, {-0.5, 0.5, 0.9}, {0.5, 0.5, 0.9}, {0.5, -0.5, 0.9}}}, 1, 1, {0.0f, 0.0f, 0, 1});
  return builder;
}

TEST(RayRows, AreWeightedByTheReflectanceOfMirrors) {
  PatchScene builder = before_mirror(Color(0.8f, 0.4f, 0.0f), 0.0f);
  const Transport transport = cast(builder.get(), 4096);
  const double hits = form_factor(transport, 4, 1, 6, 1);  // the wall at -z sees the mirror
  EXPECT_GT(hits, 0.05);
  const Vec3d by_mirror = mirrored(transport, 4);
  EXPECT_NEAR(by_mirror.x, 0.8 * hits, 0.01 * hits);
  EXPECT_NEAR(by_mirror.y, 0.4 * hits, 0.01 * hits);
  EXPECT_EQ(by_mirror.z, 0);
}

TEST(RayRows, RoughMetalsReflectNoMoreThanTheyReceive) {
  for (const float roughness : {0.1f, 0.5f, 1.0f}) {
    PatchScene builder = before_mirror(Color(1.0f), roughness);
    const Transport transport = cast(builder.get(), 4096);
    const double hits = form_factor(transport, 4, 1, 6, 1);
    EXPECT_LE(mirrored(transport, 4).x, 1.01 * hits) << roughness;
    EXPECT_GT(mirrored(transport, 4).x, 0.25 * hits) << roughness;
  }
}

TEST(RayRows, TerminateBetweenFacingMirrors) {
  PatchScene builder;
  builder.get().materials[0] = {"mirror", Color(1.0f), 0.0f};
  builder.room(1, 2, {0.0f, 0.0f});
  const Transport transport = cast(builder.get(), 64);
  EXPECT_EQ(transport.columns.size(), 24u * 64);
}

TEST(RayRows, PatchesFarSmallerThanTheirScaleCastFewerRays) {
  PatchScene builder;
  builder.room(1, 1, {});
  builder.quad({{{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}, {0, 0.1, 0}}}, 1, 1, {});
  builder.quad({{{0, 0, 0.5}, {0.9, 0, 0.5}, {0.9, 0.01, 0.5}, {0, 0.01, 0.5}}}, 1, 1, {});  // a sliver
  const auto weights = [&](double patch_area) {
    for (Primitive& p : builder.get().primitives) p.patch_area = patch_area;
    const Transport transport = cast(builder.get(), 256);
    return std::array{transport.hit_weights[0], transport.hit_weights[12], transport.hit_weights[14]};
  };
  const auto fine = weights(0.01), coarse = weights(4);
  EXPECT_EQ(fine, (std::array{1.0f / 128, 1.0f / 128, 1.0f / 128}));
  EXPECT_EQ(coarse, (std::array{1.0f / 128, 1.0f / 32, 1.0f / 128})) << "noise of slivers would show";
}

}  // namespace
}  // namespace patchlight

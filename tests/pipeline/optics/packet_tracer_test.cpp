#include "pipeline/optics/intersect/packet_tracer.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <random>

#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/intersect/surface_sizes.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

/// Quads of all shapes, some of them bent, triangles and spheres at random positions in a room.
PatchSet random_scene(int count, double size) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&](double scale) { return Vec3d(unit(random), unit(random), unit(random)) * scale; };
  PatchScene builder;
  builder.room(2, 1, {});
  for (int k = 0; k < count; ++k) {
    const Vec3d at = vector(1.8), u = vector(size), v = vector(size);
    const double a = 0.6 + 0.5 * unit(random), b = 1.2 - 0.5 * a;
    const Vec3d far = k % 5 == 0 ? at + v : at + u * a + v * b + (k % 5 == 1 ? (u % v) * 0.2 : Vec3d(0.0));
    if (k % 7 == 3)
      builder.sphere(at, (k % 2 ? 0.3 : -0.3) * size, 1, 1, {});
    else
      builder.quad({{at, at + u, far, at + v}}, 1, 1, {});
  }
  return std::move(builder.get());
}

RayPacket random_packet(std::mt19937& random, double spread) {
  std::uniform_real_distribution<float> unit(-1, 1);
  const Vec3f from(unit(random), unit(random), unit(random)), along(unit(random), unit(random), unit(random));
  RayPacket packet;
  packet.clear();
  for (int lane = 0; lane < RayPacket::kSize; ++lane)
    packet.set(lane, from, (along + Vec3f(unit(random), unit(random), unit(random)) * float(spread)).normalized());
  return packet;
}

TEST(PacketTracer, FindsTheSameHitsAsEmbree) {
  for (const auto& [count, size] : {std::pair(5, 1.0), {60, 0.5}, {2000, 0.1}, {40000, 0.02}}) {
    const PatchSet scene = random_scene(count, size);
    const RayScene packets(scene, RayScene::Tracer::packets), embree(scene, RayScene::Tracer::embree);
    std::mt19937 random(1);
    int differ = 0, rays = 0;
    for (int k = 0; k < 2000; ++k) {
      RayPacket a = random_packet(random, k % 2 ? 0.1 : 2.0), b = a;
      packets.intersect(a, true);
      embree.intersect(b, true);
      for (int lane = 0; lane < RayPacket::kSize; ++lane, ++rays) {
        const SurfaceHit one = packets.hit(a, lane), other = embree.hit(b, lane);
        if (one.primitive != other.primitive) {
          ++differ;  // hits on an edge may differ by rounding
          continue;
        }
        EXPECT_EQ(one.front, other.front);
        EXPECT_NEAR(one.t, other.t, 1e-4);
        EXPECT_NEAR(one.u, other.u, 2e-3);
        EXPECT_NEAR(one.v, other.v, 2e-3);
      }
    }
    EXPECT_LT(differ, rays / 4000) << count;
  }
}

TEST(PacketTracer, FindsTheSameOcclusionAsEmbree) {
  const PatchSet scene = random_scene(300, 0.3);
  const RayScene packets(scene, RayScene::Tracer::packets), embree(scene, RayScene::Tracer::embree);
  std::mt19937 random(2);
  int differ = 0;
  for (int k = 0; k < 2000; ++k) {
    RayPacket a = random_packet(random, 0.5);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) a.rays.ray.tfar[lane] = 0.1f * float(lane + 1);
    a.valid[k % 16] = 0;
    RayPacket b = a;
    const std::uint32_t occluded = packets.occluded(a);
    EXPECT_EQ(occluded >> k % 16 & 1u, 0u) << "an inactive lane";
    differ += std::popcount(occluded ^ embree.occluded(b));
  }
  EXPECT_LT(differ, 8);
}

TEST(PacketTracer, IsWatertightBetweenNeighbours) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    PatchScene builder;
    builder.room(scale, 1, {});
    const RayScene rays(builder.get());
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1, 1);
    for (int k = 0; k < 4000; ++k) {
      RayPacket packet;
      packet.clear();
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {  // exactly at edges and corners
        Vec3f to(unit(random), unit(random), unit(random));
        to[k % 3] = k % 2 ? 1.0f : -1.0f;
        to[(k + 1) % 3] = k % 4 < 2 ? 1.0f : -1.0f;
        if (k % 8 == 7) to[(k + 2) % 3] = 1.0f;
        packet.set(lane, Vec3f(unit(random), unit(random), unit(random)) * float(0.4 * scale), to * float(scale));
        packet.set(lane, packet.origin(lane), to * float(scale) - packet.origin(lane));
      }
      rays.intersect(packet, false);
      for (int lane = 0; lane < RayPacket::kSize; ++lane) ASSERT_GE(rays.hit(packet, lane).primitive, 0);
    }
  }
}

TEST(PacketTracer, IgnoresTheContentOfInactiveLanes) {
  const PatchSet scene = random_scene(60, 0.5);
  const RayScene rays(scene);
  std::mt19937 random(4);
  const float values[] = {
      0.0f, -1e30f, 1e30f, 1e-42f, std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()};
  for (int k = 0; k < 600; ++k) {
    RayPacket clean = random_packet(random, 0.5);
    for (int lane = 3; lane < RayPacket::kSize; ++lane) clean.valid[lane] = 0;
    RayPacket other = clean;
    for (int lane = 3; lane < RayPacket::kSize; ++lane) {
      auto& ray = other.rays.ray;
      for (float* field : {ray.org_x, ray.org_y, ray.org_z, ray.dir_x, ray.dir_y, ray.dir_z, ray.tnear, ray.tfar})
        field[lane] = values[random() % 6];
    }
    RayPacket shadows = other;
    rays.intersect(clean, true);
    rays.intersect(other, true);
    std::uint32_t hits = 0;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      EXPECT_EQ(rays.hit(other, lane).primitive, rays.hit(clean, lane).primitive);
      EXPECT_EQ(rays.hit(other, lane).t, rays.hit(clean, lane).t);
      hits |= std::uint32_t(rays.hit(clean, lane).primitive >= 0) << lane;
    }
    EXPECT_EQ(rays.occluded(shadows), hits);
  }
}

TEST(PacketTracer, HandlesAnEmptyScene) {
  const RayScene rays{PatchSet{}};
  RayPacket packet;
  packet.clear();
  packet.set(0, Vec3f(0.0f), Vec3f(1, 0, 0));
  rays.intersect(packet, false);
  EXPECT_EQ(rays.hit(packet, 0).primitive, -1);
  EXPECT_EQ(rays.occluded(packet), 0u);
}

/// A square of `cells` x `cells` quads, 1 m2, over a floor of `floor` m2.
SurfaceSizes sizes_of(int cells, double floor) {
  PatchScene builder;
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      const double x = double(i) / cells, y = double(j) / cells, h = 1.0 / cells;
      builder.quad({{{x, y, 1}, {x + h, y, 1}, {x + h, y + h, 1}, {x, y + h, 1}}}, 1, 1, {});
    }
  if (floor > 0) builder.quad({{{0, 0, 0}, {floor, 0, 0}, {floor, 1, 0}, {0, 1, 0}}}, 1, 1, {});
  return SurfaceSizes(builder.get());
}

TEST(SurfaceSizes, SuitPacketsIfFewOrRarelyFine) {
  EXPECT_TRUE(sizes_of(120, 0).suit_packets());
  const SurfaceSizes fine = sizes_of(140, 0), quarter = sizes_of(140, 3), rare = sizes_of(140, 9);
  EXPECT_EQ(rare.count, 140u * 140u + 1);
  EXPECT_NEAR(rare.fine, 0.1, 1e-6);
  EXPECT_TRUE(rare.suit_packets());
  EXPECT_FALSE(quarter.suit_packets());
  EXPECT_FALSE(quarter.mostly_fine());
  EXPECT_FALSE(fine.suit_packets());
  EXPECT_TRUE(fine.mostly_fine());
}

TEST(SurfaceSizes, CountSurfacesOnceAndPiecesSingly) {
  PatchScene builder;
  builder.room(2, 1, {});
  builder.sphere({0, 0, 0}, 1, 1, 1, {});
  PatchSet& scene = builder.get();
  scene.primitives[0].back = 1;
  scene.primitives[1].back = 0;
  scene.primitives[2].mask = 0;
  auto region = std::make_shared<Region>();
  region->pieces.resize(3);
  scene.primitives[3].region = region;
  EXPECT_EQ(SurfaceSizes(scene).count, 1u + 3u + 2u + 1u);
}

}  // namespace
}  // namespace patchlight

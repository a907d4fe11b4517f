// Rounding in ray casting: edges, gaps, distances and origins in scenes of any extent, with packets and with Embree.

#include "pipeline/optics/intersect/rounding.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <random>

#include "pipeline/optics/intersect/ray_scene.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

constexpr RayScene::Tracer kTracers[] = {RayScene::Tracer::packets, RayScene::Tracer::embree};

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine_); }
  Vec3d vector(double size) {
    const double x = (*this)(-size, size), y = (*this)(-size, size);
    return {x, y, (*this)(-size, size)};
  }

 private:
  std::mt19937 engine_;
};

/// An orthonormal frame.
std::array<Vec3d, 3> random_frame(Random& random) {
  const Vec3d x = random.vector(1).normalized(), y = (x % random.vector(1)).normalized();
  return {x, y, x % y};
}

/// A box, of which four faces are cut into strips, each at other places, so that the ends of the cuts are T-vertices.
struct Box {
  std::array<Vec3d, 3> axes;  ///< From the centre to the faces.
  Vec3d center;
  int cuts;

  Vec3d at(double x, double y, double z) const { return center + axes[0] * x + axes[1] * y + axes[2] * z; }

  void add_to(PatchScene& scene, Random& random) const {
    scene.quad({at(-1, -1, -1), at(-1, 1, -1), at(-1, 1, 1), at(-1, -1, 1)}, 1, 1, {});
    scene.quad({at(1, -1, -1), at(1, -1, 1), at(1, 1, 1), at(1, 1, -1)}, 1, 1, {});
    for (int face = 0; face < 4; ++face) {
      double from = -1;
      for (int cut = 0; cut <= cuts; ++cut) {
        const double to = cut == cuts ? 1.0 : from + random(0.1, 1.9) / (cuts + 1);
        const auto corner = [&](double x, double along) {
          const double side = face % 2 ? 1.0 : -1.0;
          return face / 2 ? at(x, along * side, side) : at(x, side, -along * side);
        };
        scene.quad({corner(from, -1), corner(to, -1), corner(to, 1), corner(from, 1)}, 1, 1, {});
        from = to;
      }
    }
  }

  /// A point of an edge or of a corner.
  Vec3d edge_point(Random& random, int k) const {
    Vec3d p(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    if (k & 8) p[k % 3] = random(-1, 1);
    return at(p.x, p.y, p.z);
  }
};

/// Which rays of escaping_fraction() are cast.
enum class Aim { edges, corners };

/// Fraction of the rays from inside of closed boxes exactly at points of their edges that hit nothing.
double escaping_fraction(RayScene::Tracer tracer, double far, int cuts, Aim aim) {
  constexpr int kBoxes = 20, kPackets = 300;
  Random random(1);
  int escaping = 0;
  for (int k = 0; k < kBoxes; ++k) {
    Box box{random_frame(random), random.vector(far), cuts};
    for (Vec3d& axis : box.axes) axis *= random(0.5, 20);
    PatchScene scene;
    if (k % 2) scene.sphere(-box.center, 1, 1, 1, {});  // moves the scene's centre away from the box
    box.add_to(scene, random);
    const RayScene ray_scene(scene.get(), tracer);
    const double inside = k % 4 < 2 ? 0.9 : 0.999;  // the latter: some rays are grazing
    for (int i = 0; i < kPackets; ++i) {
      RayPacket packet;
      packet.clear();
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const Vec3d o = random.vector(inside);
        const Vec3f origin = ray_scene.to_local(box.at(o.x, o.y, o.z));
        const Vec3d target = box.edge_point(random, (i ^ lane) % 8 + (aim == Aim::edges ? 8 : 0));
        const Vec3d to = Vec3d(ray_scene.to_local(target)) - Vec3d(origin);
        packet.set(lane, origin, i % 4 == 0 ? Vec3f(to) : Vec3f(to.normalized()));
      }
      ray_scene.intersect(packet, false);
      for (int lane = 0; lane < RayPacket::kSize; ++lane) escaping += ray_scene.hit(packet, lane).primitive < 0;
    }
  }
  return double(escaping) / (kBoxes * kPackets * RayPacket::kSize);
}

TEST(Rounding, LetsNoRayPassBetweenNeighboursAndAtTVertices) {
  for (const double far : {1.0, 100.0, 1e3, 1e4})
    for (const int cuts : {0, 1, 5})
      for (const Aim aim : {Aim::edges, Aim::corners})
        EXPECT_EQ(escaping_fraction(kTracers[0], far, cuts, aim), 0.0) << far << " " << cuts << " " << int(aim);
}

/// Embree is watertight at edges that two quads share. Exactly at corners and along edges with T-vertices, some of the
/// rays pass; few, because almost no ray is aimed at these within its rounding.
TEST(Rounding, LetsFewRaysPassBetweenNeighboursWithEmbree) {
  for (const double far : {1.0, 100.0, 1e3, 1e4}) {
    EXPECT_EQ(escaping_fraction(kTracers[1], far, 0, Aim::edges), 0.0) << far;
    EXPECT_LT(escaping_fraction(kTracers[1], far, 0, Aim::corners), 2e-3) << far;
    EXPECT_LT(escaping_fraction(kTracers[1], far, 5, Aim::edges), 2e-2) << far;
  }
}

TEST(Rounding, LetsNoRandomRayPassAtTVerticesWithEmbree) {
  Random random(2);
  Box box{random_frame(random), random.vector(1), 5};
  PatchScene scene;
  box.add_to(scene, random);
  const RayScene ray_scene(scene.get(), kTracers[1]);
  for (int k = 0; k < 60000; ++k) {
    RayPacket packet;
    packet.clear();
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const Vec3d o = random.vector(0.9);
      packet.set(lane, ray_scene.to_local(box.at(o.x, o.y, o.z)), Vec3f(random.vector(1).normalized()));
    }
    ray_scene.intersect(packet, false);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) ASSERT_GE(ray_scene.hit(packet, lane).primitive, 0);
  }
}

/// Width of the gap between two quads, between x = -0.0015 and 0.0015, for shadow rays from above at `slope` = dz / dy.
double open_width(const RayScene& ray_scene, double slope) {
  constexpr int kPackets = 500;
  constexpr double kScanned = 0.006;
  int open = 0;
  for (int k = 0; k < kPackets; ++k) {
    RayPacket packet;
    packet.clear();
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const double x = ((RayPacket::kSize * k + lane + 0.5) / (RayPacket::kSize * kPackets) - 0.5) * kScanned;
      packet.set_shadow(lane, ray_scene.to_local({x, 1.1, -0.1 * slope}), Vec3f(Vec3d(0, -1, slope).normalized()),
                        float(0.15 * std::sqrt(1 + slope * slope)));
    }
    open += RayPacket::kSize - std::popcount(ray_scene.occluded(packet));
  }
  return open * kScanned / (RayPacket::kSize * kPackets);
}

TEST(Rounding, KeepsGapsOpenBesideGroundOfAnyExtent) {
  for (const RayScene::Tracer tracer : kTracers)
    for (const double half : {5.0, 50.0, 500.0, 5000.0})
      for (const bool aside : {false, true}) {
        const double from = aside ? -0.1 * half : -half, w = 0.0015;
        PatchScene scene;
        scene.quad({{{-.5, 1, .5}, {-w, 1, .5}, {-w, 1, -.5}, {-.5, 1, -.5}}}, 1, 1, {});
        scene.quad({{{w, 1, .5}, {.5, 1, .5}, {.5, 1, -.5}, {w, 1, -.5}}}, 1, 1, {});
        scene.quad({{{from, 0, half}, {half, 0, half}, {half, 0, -half}, {from, 0, -half}}}, 1, 1, {});
        const RayScene ray_scene(scene.get(), tracer);
        const double distance = std::abs(half + from) / 2;  // from the scene's centre
        for (const double slope : {0.0, 3.0})
          EXPECT_NEAR(open_width(ray_scene, slope), 2 * w, 8e-6 + 8 * kUnitRoundoff * distance) << half << aside;
      }
}

/// The gap between two halves of the ground itself, which meet it with their first corners.
TEST(Rounding, KeepsAGapInGroundOfTenKilometresOpen) {
  constexpr double kHalf = 5000, w = 0.0015;
  for (const RayScene::Tracer tracer : kTracers) {
    PatchScene scene;
    scene.quad({{{-w, 1, -kHalf}, {-kHalf, 1, -kHalf}, {-kHalf, 1, kHalf}, {-w, 1, kHalf}}}, 1, 1, {});
    scene.quad({{{w, 1, -kHalf}, {w, 1, kHalf}, {kHalf, 1, kHalf}, {kHalf, 1, -kHalf}}}, 1, 1, {});
    EXPECT_NEAR(open_width(RayScene(scene.get(), tracer), 0), 2 * w,
                tracer == RayScene::Tracer::packets
                    ? 1e-5
                    : 4 * kUnitRoundoff * 2 * kHalf);  // Embree's overlap grows with the quad
  }
}

TEST(Rounding, FindsTheSameHitsWithBothTracers) {
  Random random(3);
  for (const double half : {10.0, 1e3, 1e4}) {
    PatchScene scene;
    scene.quad({{{-half, 0, half}, {half, 0, half}, {half, 0, -half}, {-half, 0, -half}}}, 1, 1, {});
    for (int k = 0; k < 8; ++k) {
      Box box{random_frame(random), random.vector(5) + Vec3d(0, 6, 0), 2};
      box.add_to(scene, random);
      scene.sphere(random.vector(5) + Vec3d(0, 6, 0), random(0.1, 2), 1, 1, {});
    }
    const RayScene packets(scene.get(), kTracers[0]), embree(scene.get(), kTracers[1]);
    int differ = 0;
    for (int k = 0; k < 4000; ++k) {
      RayPacket a;
      a.clear();
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        Vec3d direction = random.vector(1);
        if (k % 2) direction.y *= 1e-3;  // grazing the ground
        a.set(lane, packets.to_local(random.vector(10) + Vec3d(0, 10.1, 0)), Vec3f(direction.normalized()));
      }
      RayPacket b = a;
      packets.intersect(a, false);
      embree.intersect(b, false);
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const SurfaceHit one = packets.hit(a, lane), other = embree.hit(b, lane);
        differ += one.primitive != other.primitive;
        if (one.primitive != other.primitive || one.primitive < 0) continue;
        const Vec3f n = point_at(scene.get().primitives[one.primitive], one.u, one.v).normal;
        const float cosine = std::abs(n ^ a.direction(lane));
        if (scene.get().primitives[one.primitive].shape == Primitive::Shape::quad) {
          EXPECT_NEAR(one.t, other.t, 32 * kUnitRoundoff * (one.t + 40) / cosine);
        }
      }
    }
    EXPECT_LE(differ, 12) << half;  // of 64,000: hits on an edge may differ by rounding
  }
}

/// Of 16 * packets rays from random points of the first primitive, the number that hit it at once.
int self_hits(const RayScene& ray_scene, const PatchSet& scene, int packets, Random& random) {
  int hits = 0;
  for (int k = 0; k < packets; ++k) {
    RayPacket packet;
    packet.clear();
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const SurfacePoint point = point_at(scene.primitives[0], random(0, 1), random(0, 1));
      const Vec3d normal(point.normal);
      Vec3d direction = random.vector(1).normalized();
      if (k % 2) direction -= normal * ((direction ^ normal) * 0.9999);  // grazing
      if ((direction ^ normal) < 0) direction = -direction;
      packet.set(lane, ray_scene.to_local(point.position) + point.normal * ray_scene.offset(0),
                 Vec3f(direction.normalized()));
    }
    ray_scene.intersect(packet, false);
    for (int lane = 0; lane < RayPacket::kSize; ++lane) hits += ray_scene.hit(packet, lane).primitive == 0;
  }
  return hits;
}

TEST(Rounding, OffsetsAvoidSelfIntersection) {
  Random random(4);
  for (const RayScene::Tracer tracer : kTracers)
    for (int k = 0; k < 400; ++k) {
      const double size = std::pow(10.0, random(-2, 4)), far = std::pow(10.0, random(-2, 4));
      const auto [x, y, z] = random_frame(random);
      const Vec3d at = random.vector(far), u = x * size, v = (y * random(0.1, 1) + x * random(-1, 1)) * size;
      PatchScene scene;
      if (k % 3 == 0)
        scene.sphere(at, size, 1, 1, {});
      else
        scene.quad({at, at + u, k % 3 == 1 ? at + u + v : at + v, at + v}, 1, 1, {});
      const RayScene alone(scene.get(), tracer);
      EXPECT_EQ(self_hits(alone, scene.get(), 30, random), 0) << k << " " << size;
      if (k % 2) continue;
      scene.sphere(-at, 1e-3, 1, 1, {});  // moves the scene's centre away from the primitive
      const RayScene moved(scene.get(), tracer);
      EXPECT_EQ(self_hits(moved, scene.get(), 30, random), 0) << k << " " << size << " " << far;
    }
}

TEST(Rounding, OffsetOfAnAxisAlignedGroundDependsOnItsHeightAlone) {
  Random random(5);
  for (const RayScene::Tracer tracer : kTracers)
    for (const double half : {5e-3, 1.0, 5000.0})
      for (const double height : {0.0, 2.0}) {  // of the centre of the scene over the ground
        PatchScene scene;
        scene.quad({{{-half, 0, half}, {half, 0, half}, {half, 0, -half}, {-half, 0, -half}}}, 1, 1, {});
        if (height > 0) scene.sphere({0, 2 * height - 0.1, 0}, 0.1, 1, 1, {});
        const RayScene ray_scene(scene.get(), tracer);
        EXPECT_GT(ray_scene.offset(0), 0.0f);
        EXPECT_LE(ray_scene.offset(0), float(8 * kUnitRoundoff * height) + 1e-20f);
        EXPECT_EQ(self_hits(ray_scene, scene.get(), 200, random), 0) << half << " " << height;
      }
}

}  // namespace
}  // namespace patchlight

#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/intersect/embree_tracer.h"
#include "pipeline/optics/intersect/packet_tracer.h"

namespace patchlight {

/// Sixteen rays in the scene's local frame, and where they end.
struct alignas(64) RayPacket {
  static constexpr int kSize = 16;

  RTCRayHit16 rays;
  alignas(64) std::array<int, kSize> valid{};  ///< -1: cast this lane; 0: leave it out.

  /// Sets all lanes to go on for ever, from an origin and along a direction that the caller fills in.
  void start();
  /// Starts all lanes empty.
  void clear();
  /// Sets a lane to go from `origin` along `direction` (any length), from `t_near` on.
  void set(int lane, const Vec3f& origin, const Vec3f& direction, float t_near = 0.0f);
  /// Sets a lane to ask occluded() whether anything stands within `distance` along `direction`.
  void set_shadow(int lane, const Vec3f& origin, const Vec3f& direction, float distance);
  Vec3f origin(int lane) const { return {rays.ray.org_x[lane], rays.ray.org_y[lane], rays.ray.org_z[lane]}; }
  Vec3f direction(int lane) const { return {rays.ray.dir_x[lane], rays.ray.dir_y[lane], rays.ray.dir_z[lane]}; }
};

/// Where a ray ends: a primitive and the bilinear or spherical (u,v) on it.
struct SurfaceHit {
  std::int32_t primitive = -1;  ///< -1: nothing there.
  bool front = false;           ///< False: the unlit back of a single-sided primitive.
  float u = 0.0f;
  float v = 0.0f;
  float t = 0.0f;
};

/// The primitives of a scene as rays meet them: two-sided surfaces once, in single precision about the scene's middle.
/// Few of them are traced by a PacketTracer, more by Embree. Those with masks stand apart in a tree of Embree's that
/// lets rays through where they are not there, so that a scene without any never asks: the PatchSet must stay. The same
/// rays give the same hits for any number of threads.
class RayScene {
 public:
  /// Primitives up to which a PacketTracer serves. It is faster where that was measured, at 20 and 7,342 of them; its
  /// tree takes longer to build than Embree's.
  static constexpr std::size_t kFew = 16384;

  explicit RayScene(const PatchSet& scene, std::size_t few = kFew);
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  Vec3f to_local(const Vec3d& world) const { return Vec3f(world - origin_); }

  /// How far off primitive `i` a ray must start so as not to meet the surface it leaves, in m: some units in the last
  /// place of the primitive's own coordinates, whatever the size of the scene; of a quad that is not quite plane, as
  /// much more as its bilinear surface may lie below the two triangles that are traced.
  float offset(std::int32_t i) const { return offsets_[i]; }

  void intersect(RayPacket& packet, bool coherent) const;

  /// The lanes in whose way something stands, as bits.
  std::uint32_t occluded(RayPacket& packet) const;

  SurfaceHit hit(const RayPacket& packet, int lane) const;

 private:
  struct Quad {
    std::int32_t front;
    std::int32_t back;
    float a;  ///< Corner 2 = corner 0 + a * (corner 1 - corner 0) + b * (corner 3 - corner 0).
    float b;
    Vec3f normal;
    bool two_triangles;  ///< Traced as two triangles.
  };
  struct Sphere {
    std::int32_t outside;
    std::int32_t inside;
    Vec3f center;
  };

  void add_quads(const PatchSet& scene, float extent);
  void add_spheres(const PatchSet& scene);
  bool is_hit(unsigned quad, const Vec2f& at, const Vec3f& origin, const Vec3f& direction, float distance) const;
  SurfaceHit hit_on(unsigned geometry, unsigned index, float s, float t, const Vec3f& origin, const Vec3f& direction,
                    float distance) const;

  Vec3d origin_{0.0};
  std::optional<PacketTracer> few_;
  std::vector<float> offsets_;
  std::vector<Quad> quads_;
  std::vector<Sphere> spheres_;
  std::unique_ptr<EmbreeTracer> many_;    ///< Where they are not few.
  std::unique_ptr<EmbreeTracer> masked_;  ///< What has masks; null: nothing.
  const PatchSet* patches_ = nullptr;
};

/// (u,v) of a direction from a sphere's centre; any length.
Vec2f sphere_uv(const Vec3f& direction);

}  // namespace patchlight

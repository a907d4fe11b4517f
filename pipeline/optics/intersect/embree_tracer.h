#pragma once
#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// Quads and spheres in an Embree BVH. Embree is loaded on demand, because loading it takes longer than many stages
/// run.
class EmbreeTracer {
 public:
  static constexpr unsigned kQuads = 0, kSpheres = 1;  ///< Values of geomID.

  /// Whether to accept a hit: quad, Embree's (u,v), ray origin, direction, distance.
  using HitFilter = std::function<bool(unsigned, const Vec2f&, const Vec3f&, const Vec3f&, float)>;

  /// Throws: Error (unavailable) if Embree does not start. All methods that add or build throw std::bad_alloc.
  static std::unique_ptr<EmbreeTracer> create();

  virtual ~EmbreeTracer() = default;

  virtual void add_quads(const std::vector<std::array<Vec3f, 4>>& corners) = 0;

  /// Adds quads whose hits `filter` may reject; their primID starts at `first`.
  virtual void add_filtered_quads(const std::vector<std::array<Vec3f, 4>>& corners, unsigned first,
                                  HitFilter filter) = 0;

  /// Adds spheres: x, y, z of the centre and the radius.
  virtual void add_spheres(const std::vector<std::array<float, 4>>& spheres) = 0;

  /// Builds the BVH. Call once, after all geometry is added and before the first ray.
  virtual void build() = 0;

  /// Finds the closest hits. `valid`: -1 for active lanes, else 0; tnear and tfar of inactive lanes are overwritten.
  virtual void intersect(const std::array<int, 16>& valid, RTCRayHit16& rays, bool coherent) const = 0;

  /// The rays among `active` that are occluded, a bit each. Overwrites tnear and tfar.
  virtual std::uint32_t occluded(RTCRay16& rays, std::uint32_t active) const = 0;
};

}  // namespace patchlight

#pragma once
#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// Quads and spheres in a tree of Embree's, which is loaded when there is one to build: it takes longer than many
/// programs work.
class EmbreeTracer {
 public:
  static constexpr unsigned kQuads = 0, kSpheres = 1;  ///< Geometries, as a ray's hit tells them.

  /// Whether a ray meets a quad where it comes to it: quad, (u,v) on it, origin, direction, distance.
  using Filter = std::function<bool(unsigned, const Vec2f&, const Vec3f&, const Vec3f&, float)>;

  /// Throws: Error (unavailable) where Embree does not start; std::bad_alloc, as build() does.
  static std::unique_ptr<EmbreeTracer> start();

  virtual ~EmbreeTracer() = default;

  virtual void add_quads(const std::vector<std::array<Vec3f, 4>>& corners) = 0;

  /// Quads that rays meet where `filter` says so, numbered from `first` on.
  virtual void add_filtered_quads(const std::vector<std::array<Vec3f, 4>>& corners, unsigned first, Filter filter) = 0;

  /// Of spheres: centre and radius.
  virtual void add_spheres(const std::vector<std::array<float, 4>>& spheres) = 0;

  /// After all is added, before the first ray.
  virtual void build() = 0;

  /// `valid`: -1 for rays that are cast, else 0; these lose their ends.
  virtual void intersect(const std::array<int, 16>& valid, RTCRayHit16& rays, bool coherent) const = 0;

  /// The rays among `wanted` in whose way something stands, as bits. All may lose their ends.
  virtual std::uint32_t occluded(RTCRay16& rays, std::uint32_t wanted) const = 0;
};

}  // namespace patchlight

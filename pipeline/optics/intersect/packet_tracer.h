#pragma once
#include <ImathBox.h>
#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/model/math.h"
#include "pipeline/optics/intersect/packet_kernel.h"

namespace patchlight {

/// Traces packets of sixteen coherent rays through a BVH of quads and spheres. Every box and primitive is intersected
/// with all lanes at once, in code that the compiler vectorises. With some thousands of primitives it is two to three
/// times as fast as Embree.
class PacketTracer {
 public:
  /// Adds quad number `index`, whose corners are floats. A quad that is not planar within the rounding of its corners
  /// becomes the triangles (0,1,3) and (2,3,1) as in Embree; (s,t) of the second is (1,1) minus (s,t) in the frame of
  /// its edges at corner 2. Returns whether the quad is planar.
  bool add_quad(const std::array<Vec3d, 4>& corners, std::int32_t index);
  void add_sphere(const Vec3d& center, double radius, std::int32_t index);
  /// Call once, after all primitives are added and before the first ray.
  void build();

  /// Finds the closest hit of each active lane between tnear and tfar. Sets tfar to its distance, geomID to 0 for a
  /// quad and 1 for a sphere, primID to its index, and for quads u and v to (s,t) in the frame of the edges at corner
  /// 0. Lanes without a hit stay unchanged. `active`: a bit per lane; tnear and tfar of the other lanes are
  /// overwritten.
  void intersect(RTCRayHit16& rays, std::uint32_t active) const;

  /// The lanes of `active` that are occluded between tnear and tfar, a bit each.
  std::uint32_t occluded(const RTCRay16& rays, std::uint32_t active) const;

 private:
  void add_reference(std::int32_t surface, std::size_t shape, const Imath::Box3d& box);
  void add_facet(const std::array<Vec3d, 4>& corners, const Vec3d& normal, std::int32_t surface, bool second);
  void trace(packet::Rays& rays, std::uint32_t occlusion_lanes) const;

  const packet::TraceFunction trace_ = packet::fastest_trace();
  std::vector<packet::Facet> facets_;
  std::vector<packet::Sphere> spheres_;
  std::vector<packet::PrimitiveReference> references_;
  std::vector<Imath::Box3f> boxes_;  ///< Bounds of the references, until build().
  std::vector<packet::Node> nodes_;
};

}  // namespace patchlight

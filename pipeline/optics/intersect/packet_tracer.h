#pragma once
#include <ImathBox.h>
#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/model/math.h"
#include "pipeline/optics/intersect/packet_kernel.h"

namespace patchlight {

/// Finds what packets of sixteen rays that go much the same way meet among a few thousand quads and spheres, or fewer:
/// all lanes against a bounding box or a surface at a time, in code that the compiler makes vectors of. Coarse
/// primitives are few, and this traces rows of them two to three times as fast as Embree does.
class PacketTracer {
 public:
  /// A quad by its corners, the `index`th; one that is not plane to `precision`, m, is the triangles (0,1,3) and
  /// (2,3,1), as Embree has it, and (s,t) of the second are one minus those in the frame of its edges at corner 2.
  /// Returns whether it is plane.
  bool add_quad(const std::array<Vec3d, 4>& corners, double precision, std::int32_t index);
  void add_sphere(const Vec3d& center, double radius, std::int32_t index);
  /// To be called once, after all surfaces are there.
  void build();

  /// The nearest surface in each lane's way between tnear and tfar: sets tfar to its distance, geomID to 0 for a quad
  /// and 1 for a sphere, primID to its index, and u and v, of quads, to (s,t) in the frame of the edges at corner 0.
  /// Lanes that meet nothing keep what they have.
  /// Lanes that are not `wanted` cost nothing, whatever they hold, and lose their ends.
  void intersect(RTCRayHit16& rays, std::uint32_t wanted) const;

  /// The lanes of `wanted` in whose way something stands, as bits.
  std::uint32_t occluded(const RTCRay16& rays, std::uint32_t wanted) const;

 private:
  void add_reference(std::int32_t surface, std::size_t shape, const Imath::Box3d& box);
  void add_facet(const Vec3d& corner, const Vec3d& along_s, const Vec3d& along_t, const Vec2f& shape, double precision,
                 bool second);
  void trace(packet::Rays& rays, std::uint32_t wanted) const;

  const packet::Trace trace_ = packet::fastest();
  std::vector<packet::Facet> facets_;
  std::vector<packet::Ball> balls_;
  std::vector<packet::PrimitiveReference> items_;
  std::vector<Imath::Box3f> boxes_;  ///< Of the items, until the tree is built.
  std::vector<packet::Node> nodes_;
};

}  // namespace patchlight

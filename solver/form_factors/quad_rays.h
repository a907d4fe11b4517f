#pragma once
#include <array>
#include <cstdint>

#include "pipeline/optics/intersect/ray_scene.h"
#include "solver/form_factors/direction_table.h"

namespace patchlight {

/// A quad patch in the scene's local frame: p = corner + u along_u + v along_v + uv twist.
struct QuadPatch {
  Vec3f corner, along_u, along_v, twist;
  Vec3f tangent, bitangent, normal;
  std::array<float, 4> density;  ///< Area per (u,v) at the corners 00, 10, 01, 11.
};

/// `offset`: distance of ray origins from the surface, m.
QuadPatch make_quad_patch(const RayScene& ray_scene, const Primitive& primitive, const Patch& patch, float offset);

/// Sixteen directions about +Z with the density cos / pi, and points of the unit square.
struct QuadSamples {
  using Lanes = std::array<float, RayPacket::kSize>;

  Lanes dx, dy, dz, u, v;
};

/// Sets `samples` to the points `first` and following of the table, after exclusive or with `shift`.
void shift_samples(const DirectionTable& table, int first, const std::array<std::uint32_t, 4>& shift,
                   QuadSamples& samples);

/// Sets the packet's rays: their origins uniformly over the patch's area, their directions about its normal.
/// Overwrites the samples' u and v.
void set_quad_rays(const QuadPatch& patch, QuadSamples& samples, RayPacket& packet);

}  // namespace patchlight

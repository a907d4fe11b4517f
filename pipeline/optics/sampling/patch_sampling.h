#pragma once
#include <array>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// A point on a surface with the unit normal of the lit side there.
struct SurfacePoint {
  Vec3d position;
  Vec3f normal;
};

/// The place of a quad's point at (u,v).
Vec3d position_at(const std::array<Vec3d, 4>& corners, double u, double v);

/// The point of a primitive at (u,v).
SurfacePoint point_at(const Primitive& primitive, double u, double v);

/// Maps points of a patch's unit square to points of equal density over its area (exact for planar patches and for
/// spheres).
class PatchSampler {
 public:
  PatchSampler(const Primitive& primitive, const Patch& patch);
  SurfacePoint operator()(float x, float y) const;
  /// (u,v) of that point on the primitive.
  Imath::V2d uv(float x, float y) const;

 private:
  const Primitive& primitive_;
  const Patch& patch_;
  double cos_top_ = 0, cos_bottom_ = 0;  ///< Sphere: of the polar angles that bound the patch.
  double density_[4]{1, 1, 1, 1};        ///< Quad: area per (u,v) at the patch's corners 00, 10, 01, 11.
};

/// A direction about +Z with density cos / pi: Malley's method.
Vec3f cosine_direction(float x, float y);

/// Two unit vectors that make a right-handed frame with the unit vector n (Duff et al. 2017, JCGT 6-1).
void orthonormal_frame(const Vec3f& n, Vec3f& tangent, Vec3f& bitangent);

}  // namespace patchlight

#pragma once
#include <array>
#include <vector>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// A point on a surface, with the unit normal on the lit side.
struct SurfacePoint {
  Vec3d position;
  Vec3f normal;
};

/// The surface point of a primitive at (u,v).
SurfacePoint point_at(const Primitive& primitive, double u, double v);

/// The (u,v) of a point of a plane quad.
Imath::V2d uv_of(const Primitive& quad, const Vec3d& position);

/// Maps the unit square to a patch, uniformly in area (exact for planar patches and for spheres).
class PatchSampler {
 public:
  /// The patch's primitives are among `primitives`.
  PatchSampler(const std::vector<Primitive>& primitives, const Patch& patch);
  SurfacePoint operator()(float x, float y) const;

  struct Place {
    std::int32_t primitive;
    Imath::V2d uv;
  };
  /// The primitive and the (u,v) of that point.
  Place place(float x, float y) const;

 private:
  /// x in the range of one of the parts that follow each other along it, and that part.
  std::pair<std::size_t, double> part_at(double x) const;
  Vec3d in_triangles(double x, double y) const;

  const Primitive& primitive_;  ///< Of a cluster, the first facet.
  const Patch& patch_;
  double cos_top_ = 0, cos_bottom_ = 0;        ///< Sphere: cosines of the patch's polar angles.
  std::array<double, 4> density_{1, 1, 1, 1};  ///< Quad: area per du dv at the patch's corners 00, 10, 01, 11.
  /// Of a part of a cell, twice the area of its first k triangles; of a cluster, the area of its first k facets.
  std::vector<double> areas_{};
};

/// A direction about +Z with density cos / pi per sr, by Malley's method; x and y in [0,1).
Vec3f cosine_direction(float x, float y);

/// A right-handed orthonormal frame about the unit vector n (Duff et al. 2017, JCGT 6-1).
void orthonormal_frame(const Vec3f& n, Vec3f& tangent, Vec3f& bitangent);

}  // namespace patchlight

#include "solver/display/region_vertices.h"

#include <algorithm>
#include <limits>
#include <unordered_map>

#include "pipeline/model/cuts/region_shape.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

namespace {

constexpr double kInwards = 0.05;  // of the way from the nearest point to the middle of its triangle

/// A point in one of the triangles (their corners), near a given one outside of all.
Vec3d point_inside(const std::vector<Vec3d>& triangles, const Vec3d& point) {
  Vec3d result = point;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const std::size_t first = k - k % 3;
    const Vec3d &a = triangles[k], &b = triangles[first + (k + 1) % 3], along = b - a;
    const double length = along.length2();
    const Vec3d nearest = a + along * (length > 0 ? std::clamp(((point - a) ^ along) / length, 0.0, 1.0) : 0.0);
    if (const double distance = (nearest - point).length2(); distance < least) {
      least = distance;
      const Vec3d middle = (triangles[first] + triangles[first + 1] + triangles[first + 2]) / 3.0;
      result = nearest + (middle - nearest) * kInwards;
    }
  }
  return result;
}

}  // namespace

void move_into_regions(const PatchSet& scene, const PatchLookup& lookup, std::vector<DisplayMesh::Vertex>& vertices) {
  struct Place {
    PlaneFrame frame;
    RegionShape shape;
  };
  std::unordered_map<std::int32_t, Place> places;
  for (DisplayMesh::Vertex& vertex : vertices) {
    const std::int32_t i = scene.patches[vertex.patch].primitive;
    const Primitive& primitive = scene.primitives[i];
    if (!primitive.region) continue;
    auto at = places.find(i);
    if (at == places.end()) {
      const PlaneFrame frame = *PlaneFrame::of(primitive);
      at = places.emplace(i, Place{frame, RegionShape(primitive, frame)}).first;
    }
    const Vec3d point = position_at(primitive.corners, vertex.u, vertex.v);
    if (at->second.shape.holds(at->second.frame.to_plane(point))) continue;
    vertex.patch = lookup.patch(i, vertex.u, vertex.v);
    const Imath::V2d uv = uv_of(primitive, point_inside(scene.patches[vertex.patch].triangles, point));
    vertex.u = float(uv.x);
    vertex.v = float(uv.y);
  }
}

}  // namespace patchlight

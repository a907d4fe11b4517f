#pragma once
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/surface/smooth_edges.h"
#include "tracer/sampling/outline_canvas.h"

namespace patchlight {

/// Edges of a scene's surfaces in an image: every edge at a crease or border, and of smooth surfaces the silhouette.
/// They are drawn from the geometry, so no surface is too thin to be found.
class Outlines {
 public:
  /// `smooth`: of the scene's primitives.
  Outlines(const PatchSet& scene, const SmoothEdges& smooth);

  /// Surface id of primitive `i`; primitives that meet smoothly share one.
  std::int32_t surface(std::int32_t i) const { return surfaces_[i]; }

  /// Unit normal of quad `i`.
  const Vec3d& normal(std::int32_t i) const { return normals_[i]; }

  /// Depth of the nearest edge in each pixel, hidden or not, widened by a lens; infinity without an edge.
  /// Shape: [width * height], rows from the top.
  std::vector<float> draw(const CameraRays& rays, int width, int height) const;

 private:
  /// An edge of one primitive, or of two that meet smoothly at an angle; the latter is drawn if only one of the two
  /// faces the camera.
  struct Edge {
    std::int32_t primitive;
    std::int32_t other;  ///< -1: none.
    std::int32_t edge;   ///< Of `primitive`, from its corner of this number.
  };

  void add_edges(const SmoothEdges& smooth);
  std::int32_t find_root(std::int32_t i);
  void draw_sphere(const Primitive& sphere, OutlineCanvas& canvas) const;

  const PatchSet& scene_;
  std::vector<Vec3d> normals_;          ///< [primitives]; zero for spheres.
  std::vector<std::int32_t> surfaces_;  ///< [primitives]. A disjoint-set forest until the constructor has ended.
  std::vector<Edge> edges_;
};

}  // namespace patchlight

#pragma once
#include <vector>

#include "pipeline/model/patch_set.h"
#include "tracer/sampling/camera_rays.h"

namespace patchlight {

/// Where the edges of a scene's surfaces lie in an image: of surfaces that run on smoothly only what is their outline
/// from the camera, of all others each edge. Drawn from the geometry, so that nothing is too thin to be found.
class Outlines {
 public:
  explicit Outlines(const PatchSet& scene);

  /// Primitives that meet smoothly are one surface: a number for each primitive's.
  std::int32_t surface(std::int32_t i) const { return surfaces_[i]; }

  /// Unit normal of a quad.
  const Vec3d& normal(std::int32_t i) const { return normals_[i]; }

  /// For each pixel the depth of the nearest edge that passes through it, hidden or not; infinity where there is none.
  /// Shape: [width * height], in rows from the top.
  std::vector<float> draw(const CameraRays& rays, int width, int height) const;

 private:
  /// A side of one primitive, or where two meet smoothly at an angle: an edge where only one of them faces the camera.
  struct Edge {
    Vec3d from{0.0}, to{0.0};
    std::int32_t primitive = -1;
    std::int32_t other = -1;
  };
  struct Canvas;

  void add_sides();
  std::int32_t root(std::int32_t i);
  void draw_sphere(const Primitive& sphere, Canvas& canvas) const;

  const PatchSet& scene_;
  std::vector<Vec3d> normals_;  ///< Of quads.
  std::vector<std::int32_t> surfaces_;
  std::vector<Edge> edges_;
};

}  // namespace patchlight

#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/sampling/patch_lookup.h"
#include "solver/hemicube/gl_context.h"

namespace patchlight {

/// A pinhole view for rasterising: right x up = -forward, all unit vectors.
struct GlView {
  Vec3f eye{0.0f};  ///< In the renderer's local frame.
  Vec3f right{0.0f};
  Vec3f up{0.0f};
  Vec3f forward{0.0f};
  float width = 1.0f;    ///< Half width of the image plane at distance 1.
  float bottom = -1.0f;  ///< The image plane's lower and upper edge at distance 1.
  float top = 1.0f;
  float near = 1e-4f;
  std::int32_t self = -1;    ///< Primitive whose surface the eye is on; -1: none.
  bool self_inside = false;  ///< Whether the eye is on the inside of a sphere.
};

/// Draws patch ids with OpenGL. It draws whole primitives and the fragment shader finds the patch from (u,v), so the
/// cost does not depend on the number of patches. The fragment shader also intersects spheres and tests alpha masks.
///
/// Ids are patch + 1; 0: background, or the unlit back of a single-sided surface. Depth is reversed floating point with
/// an infinite far plane: its relative precision is the same at all distances.
class PatchIdRenderer {
 public:
  /// Throws: Error (unavailable) without OpenGL.
  explicit PatchIdRenderer(const PatchSet& scene);
  ~PatchIdRenderer();

  Vec3f to_local(const Vec3d& world) const { return Vec3f(world - origin_); }

  /// Allocates and clears an image of `width` x `height` ids. Throws: Error (over_limit) if the driver cannot.
  void begin(int width, int height);

  /// Draws a view into a rectangle of the image, from its lower left corner.
  void draw(const GlView& view, int x, int y, int width, int height);

  /// The image, rows from the bottom. Shape: [height * width].
  const std::vector<std::uint32_t>& read();

 private:
  /// Quads that one shader program draws.
  struct Quads {
    unsigned program = 0, array = 0;
    int vertices = 0;
  };

  Quads upload_quads(const PatchSet& scene, const PatchLookup& lookup, bool masked) const;
  void upload_masks(const PatchSet& scene) const;
  void upload_cuts(const PatchLookup& lookup) const;
  void upload_spheres(const PatchSet& scene, const PatchLookup& lookup);

  GlContext context_;
  Vec3d origin_{0.0};
  int width_ = 0, height_ = 0;
  unsigned framebuffer_ = 0, ids_ = 0, depth_ = 0;
  Quads opaque_, masked_;
  unsigned sphere_program_ = 0, sphere_array_ = 0;
  std::vector<std::int32_t> sphere_of_;  ///< [primitives] Index of the drawn sphere; -1: not a sphere.
  int spheres_ = 0;
  std::vector<std::uint32_t> pixels_;
};

}  // namespace patchlight

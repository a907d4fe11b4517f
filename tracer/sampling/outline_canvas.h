#pragma once
#include <vector>

#include "tracer/sampling/camera_rays.h"

namespace patchlight {

/// Depth buffer of an image that edges are drawn into, hidden ones too. A lens widens them by its circles of confusion,
/// as far as `kMaxMargin` pixels and a quarter of the image.
class OutlineCanvas {
 public:
  static constexpr int kMaxMargin = 256;

  OutlineCanvas(const CameraRays& camera_rays, int width, int height);

  const CameraRays& rays;

  /// Draws a line between two points in camera space.
  void draw_line(Vec3d a, Vec3d b);

  /// Depth of the nearest edge in each pixel; infinity without an edge. Call it once, after all lines.
  /// Shape: [width * height], rows from the top.
  std::vector<float> depths();

 private:
  int level_of(float depth) const;
  std::vector<float>& plane(int level);

  const int margin_;                        ///< Pixels around the image whose edges a lens may widen into it.
  const int width_, height_;                ///< With the margins.
  std::vector<std::vector<float>> planes_;  ///< By level: edges of about the same blur, before they are widened.
};

}  // namespace patchlight

#pragma once
#include "pipeline/model/camera.h"

namespace patchlight {

/// A ray in world space; the direction is a unit vector.
struct CameraRay {
  Vec3d origin;
  Vec3f direction;
};

/// Rays of a camera through an image of `width` x `height` pixels. The image keeps the camera's vertical extent.
class CameraRays {
 public:
  CameraRays(const Camera& camera, int width, int height);

  /// The ray through image point (x, y) in pixels from the upper left corner.
  CameraRay operator()(float x, float y) const;

 private:
  Camera camera_;
  double half_width_, half_height_;  ///< Of the image plane: at distance 1, or in m for orthographic cameras.
  double pixels_across_, pixels_down_;
};

}  // namespace patchlight

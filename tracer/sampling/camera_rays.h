#pragma once
#include <array>

#include "pipeline/model/camera.h"
#include "pipeline/optics/intersect/ray_scene.h"

namespace patchlight {

/// Points of an image, in pixels from the upper left corner.
struct ImagePoints {
  std::array<float, RayPacket::kSize> x{}, y{};
};

/// Rays of a camera through an image of `width` x `height` pixels. The image keeps the camera's vertical extent.
class CameraRays {
 public:
  CameraRays(const Camera& camera, int width, int height);

  /// Sets all lanes to the rays through these points. Directions are unit vectors.
  void start(const ImagePoints& at, const RayScene& scene, RayPacket& packet) const;

  bool perspective() const { return camera_.projection == Camera::Projection::perspective; }
  /// Where rays start, or, for orthographic cameras, a point of the plane where they do.
  const Vec3d& eye() const { return eye_; }
  /// Unit vector along the middle ray.
  const Vec3d& forward() const { return forward_; }

  /// A point in the camera's own axes: x to the right, y up, z = -depth, depths growing away from the camera.
  Vec3d to_camera(const Vec3d& world) const;
  /// How far a point lies before the camera, along its axis.
  double depth(const Vec3d& world) const { return (world - eye_) ^ forward_; }
  /// The image point of a point in the camera's axes; in perspective, of one of positive depth.
  Imath::V2d to_image(const Vec3d& in_camera) const;

 private:
  Camera camera_;
  Matrix4 to_camera_;
  double half_width_, half_height_;  ///< Of the image plane: at distance 1, or in m for orthographic cameras.
  double pixels_across_, pixels_down_;
  Vec3d eye_, forward_;
  /// In the world: towards the image's upper left corner, or that corner itself in parallel projection, and from one
  /// pixel to the next.
  Vec3d first_, across_, down_;
};

}  // namespace patchlight

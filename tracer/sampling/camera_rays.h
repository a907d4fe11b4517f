#pragma once
#include <array>

#include "pipeline/model/camera.h"
#include "pipeline/optics/intersect/ray_scene.h"

namespace patchlight {

/// Image points in pixels from the upper left corner, one for each lane of a packet.
struct ImagePoints {
  std::array<float, RayPacket::kSize> x{}, y{};
};

/// Rays of a camera through an image of `width` x `height` pixels. The image keeps the camera's vertical extent.
class CameraRays {
 public:
  CameraRays(const Camera& camera, int width, int height);

  /// Sets all lanes to the rays through `points`. Directions are unit vectors.
  void generate(const ImagePoints& points, const RayScene& scene, RayPacket& packet) const;

  bool perspective() const { return camera_.projection == Camera::Projection::perspective; }
  /// Origin of all rays; for an orthographic camera the centre of the plane where rays start.
  const Vec3d& eye() const { return eye_; }
  /// Unit vector along the optical axis.
  const Vec3d& forward() const { return forward_; }

  /// Transforms a point to camera space: x to the right, y up, z = -depth.
  Vec3d to_camera(const Vec3d& world) const;
  /// Distance of a point from the camera along the optical axis, m; negative behind the camera.
  double depth(const Vec3d& world) const { return (world - eye_) ^ forward_; }
  /// Image point of a point in camera space; for a perspective camera its depth must be positive.
  Imath::V2d to_image(const Vec3d& in_camera) const;

 private:
  Camera camera_;
  Matrix4 to_camera_;
  double half_width_, half_height_;  ///< Of the image plane at distance 1, or in m for an orthographic camera.
  double width_, height_;            ///< Pixels.
  Vec3d eye_, forward_;
  /// In the world: direction of the image's upper left corner (its position for an orthographic camera), and the steps
  /// to the next pixel to the right and down.
  Vec3d corner_, right_, down_;
};

}  // namespace patchlight

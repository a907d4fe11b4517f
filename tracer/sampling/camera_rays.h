#pragma once
#include <array>
#include <cmath>

#include "pipeline/model/camera.h"
#include "pipeline/optics/intersect/ray_scene.h"

namespace patchlight {

/// Image points in pixels from the upper left corner, one for each lane of a packet.
struct ImagePoints {
  std::array<float, RayPacket::kSize> x{}, y{};
  /// Points of the lens opening, in its radii to the right and up from its centre, at which they begin. Not read
  /// without a lens.
  std::array<Vec2f, RayPacket::kSize> lens;

  ImagePoints() { lens.fill(Vec2f(0.0f)); }
};

/// Rays of a camera through an image of `width` x `height` pixels. The image keeps the camera's vertical extent. Rays
/// start and end at the camera's clip depths. With a lens, the rays of an image point start anywhere in its opening and
/// meet at its focus (Cook, Porter and Carpenter 1984).
class CameraRays {
 public:
  CameraRays(const Camera& camera, int width, int height);

  /// Sets all lanes to the rays through `points`. Directions are unit vectors.
  void generate(const ImagePoints& points, const RayScene& scene, RayPacket& packet) const;

  /// Ends a ray that continues a camera ray from `position` at the camera's far clip depth.
  void set_end(RayPacket& packet, int lane, const Vec3d& position, const Vec3f& direction) const;

  /// Whether the camera's clip depths leave nothing between two depths.
  bool clips(double nearest, double farthest) const { return farthest < camera_.znear || nearest > camera_.zfar; }

  bool has_lens() const { return camera_.has_lens(); }
  /// Diameter of the circle of confusion at a depth, m: what a lens blurs into one image point.
  double blur(double depth) const { return camera_.aperture * std::abs(depth / camera_.focus - 1); }
  /// Height of a pixel at a depth, m.
  double pixel_size(double depth) const { return 2 * half_height_ / height_ * (perspective() ? depth : 1.0); }

  bool perspective() const { return camera_.projection == Camera::Projection::perspective; }
  /// Origin of all rays; for an orthographic camera the centre of the plane where rays start.
  const Vec3d& eye() const { return eye_; }
  /// Unit vector along the optical axis.
  const Vec3d& forward() const { return forward_; }

  /// Transforms a point to camera space: x to the right, y up, z = -depth.
  Vec3d to_camera(const Vec3d& world) const;
  /// Distance of a point from the camera along the optical axis, m; negative behind the camera.
  double depth(const Vec3d& world) const { return (world - eye_) ^ forward_; }
  /// Image point, by the centre of the lens, of a point in camera space; for a perspective camera its depth must be
  /// positive.
  Imath::V2d to_image(const Vec3d& in_camera) const;

 private:
  void move_to_lens(const ImagePoints& points, RayPacket& packet) const;
  void clip(RayPacket& packet) const;

  Camera camera_;
  Matrix4 to_camera_;
  double half_width_, half_height_;  ///< Of the image plane at distance 1, or in m for an orthographic camera.
  double width_, height_;            ///< Pixels.
  Vec3d eye_, forward_;
  /// In the world: direction of the image's upper left corner (its position for an orthographic camera), and the steps
  /// to the next pixel to the right and down.
  Vec3d corner_, right_, down_;
  Vec3d lens_right_{0.0}, lens_up_{0.0};  ///< Radii of the lens opening.
};

}  // namespace patchlight

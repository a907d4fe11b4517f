#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/model/motion.h"

namespace patchlight {

/// Ranges of a lens that files and jobs accept; lengths in m.
inline constexpr double kMaxShift = 100, kMinAspect = 1e-3, kMaxAspect = 1e3, kMaxAperture = 1e6, kMinDepth = 1e-9,
                        kMaxDepth = 1e9;

/// A camera in world space: it looks along its local -Z, with +Y up. Depths are distances along this axis.
struct Camera {
  enum class Projection : std::int32_t { perspective = 0, orthographic = 1 };

  std::string name;  ///< Name of the glTF node, or of the camera in the job.
  Projection projection = Projection::perspective;
  Matrix4 to_world;           ///< Rigid. For an animated camera: the transform without animation.
  double vertical = 0.7;      ///< Perspective: full vertical field of view, rad. Orthographic: half height, m.
  double aspect = 4.0 / 3.0;  ///< Width over height, of frames of a job that sets no resolution.
  Vec2d shift{0.0};           ///< Of the image's centre to the right and up, in widths and heights of the image.
  double znear = 0.0;         ///< Depth where camera rays start, m.
  double zfar = std::numeric_limits<double>::infinity();  ///< Depth where camera rays end, m.
  double aperture = 0.0;  ///< Diameter of the lens opening, m; 0: a pinhole, which shows all depths sharp.
  double focus = 0.0;     ///< Depth that a lens shows sharp, m; 0: not known.
  /// Animated camera: factors of its transform, from camera space to world space. Empty: a static camera.
  std::vector<Motion> motion;

  bool has_lens() const { return aperture > 0; }
};

/// What is wrong with a camera's lens; empty: nothing.
std::string lens_fault(const Camera& camera);

/// The rigid camera frame of a transform: removes scale, shear and mirroring, keeps the view direction and then the up
/// direction. Empty if the transform is degenerate.
std::optional<Matrix4> rigid_frame(const Matrix4& to_world);

/// The rigid frame of an animated camera at a time in s; empty if its transform is degenerate at that time.
std::optional<Matrix4> to_world_at(const Camera& camera, double seconds);

}  // namespace patchlight

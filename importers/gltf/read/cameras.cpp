#include "importers/gltf/read/cameras.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

Matrix4 frame(const Vec3d& x, const Vec3d& y, const Vec3d& z, const Vec3d& origin) {
  return {x.x, x.y, x.z, 0.0, y.x, y.y, y.z, 0.0, z.x, z.y, z.z, 0.0, origin.x, origin.y, origin.z, 1.0};
}

}  // namespace

std::optional<Camera> read_camera(const tinygltf::Camera& source, const GltfLens& lens, const Matrix4& to_world,
                                  const std::string& node, Progress& progress) {
  const std::optional<Matrix4> rigid = rigid_frame(to_world);
  if (!rigid) return std::nullopt;
  Camera camera;
  camera.name = node;
  camera.to_world = *rigid;
  double aspect = 0.0, znear = 0.0, zfar = 0.0;
  if (source.type == "orthographic") {
    camera.projection = Camera::Projection::orthographic;
    camera.vertical = source.orthographic.ymag;
    aspect = source.orthographic.xmag / source.orthographic.ymag;
    znear = source.orthographic.znear;
    zfar = source.orthographic.zfar;
    if (!(camera.vertical > 0.0)) return std::nullopt;
  } else {
    camera.vertical = source.perspective.yfov;
    aspect = source.perspective.aspectRatio;
    znear = source.perspective.znear;
    zfar = source.perspective.zfar;
    if (!(camera.vertical > 0.0 && camera.vertical < kPi)) return std::nullopt;
  }
  if (aspect >= kMinAspect && aspect <= kMaxAspect) camera.aspect = aspect;
  if (zfar == 0.0) zfar = camera.zfar;  // absent
  if (znear >= 0.0 && znear <= kMaxDepth && zfar > znear) {
    camera.znear = znear;
    camera.zfar = zfar;
  } else {
    progress.warning(
        fmt::format("camera '{}': znear {} and zfar {} leave nothing to see and are ignored", node, znear, zfar));
  }
  camera.shift = lens.shift.value_or(camera.shift);
  camera.aspect = lens.aspect.value_or(camera.aspect);
  camera.aperture = lens.aperture.value_or(0.0);
  camera.focus = lens.focus.value_or(0.0);
  return camera;
}

Camera framing_camera(const Vec3d& box_min, const Vec3d& box_max) {
  constexpr double angle = 40.0 * kPi / 180.0;
  constexpr double looking_down = 15.0 * kPi / 180.0;
  const Vec3d center = (box_min + box_max) * 0.5;
  const double radius = std::max((box_max - box_min).length() * 0.5, 1e-6);
  const Vec3d z(0.0, std::sin(looking_down), std::cos(looking_down));
  const Vec3d x(1.0, 0.0, 0.0);
  Camera camera;
  camera.name = "default";
  camera.vertical = angle;
  camera.to_world = frame(x, z.cross(x), z, center + z * (radius / std::sin(angle / 2.0)));
  return camera;
}

}  // namespace patchlight

#include "pipeline/frames/camera_view.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace patchlight {

namespace {

constexpr int kCorners = 8, kEdges = 4;

/// The four edges of a camera's view, each a point and a direction, in the world.
struct ViewEdges {
  std::array<Vec3d, kEdges> from{}, along{};
};

ViewEdges view_edges(const Camera& camera, double half_width, double half_height) {
  const bool perspective = camera.projection == Camera::Projection::perspective;
  ViewEdges edges;
  for (int i = 0; i < kEdges; ++i) {
    const Vec3d offset(i % 2 == 0 ? -half_width : half_width, i / 2 == 0 ? -half_height : half_height, 0);
    camera.to_world.multVecMatrix(perspective ? Vec3d(0.0) : offset, edges.from[i]);
    camera.to_world.multDirMatrix(Vec3d(0, 0, -1) + (perspective ? offset : Vec3d(0.0)), edges.along[i]);
  }
  return edges;
}

/// Whether a side of the view, or the plane of the camera, has the whole box behind it.
bool is_beside_view(const Camera& camera, double half_width, double half_height, const Imath::Box3d& box) {
  const bool perspective = camera.projection == Camera::Projection::perspective;
  const Matrix4 to_camera = camera.to_world.inverse();
  std::array<bool, 5> all_behind{true, true, true, true, true};
  for (int i = 0; i < kCorners; ++i) {
    const Vec3d corner(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z);
    Vec3d p;
    to_camera.multVecMatrix(corner, p);
    const double depth = perspective ? -p.z : 1.0;
    const double right = half_width * depth, top = half_height * depth;
    const std::array<bool, 5> behind{p.x > right, p.x<-right, p.y> top, p.y<-top, p.z> 0};
    for (std::size_t k = 0; k < behind.size(); ++k) all_behind[k] = all_behind[k] && behind[k];
  }
  return std::find(all_behind.begin(), all_behind.end(), true) != all_behind.end();
}

/// Whether the whole view lies beyond one face of the box.
bool is_beyond_face(const ViewEdges& view, const Imath::Box3d& box) {
  for (int k = 0; k < 3; ++k) {
    bool below = true, above = true;
    for (int i = 0; i < kEdges; ++i) {
      below = below && view.from[i][k] < box.min[k] && view.along[i][k] <= 0;
      above = above && view.from[i][k] > box.max[k] && view.along[i][k] >= 0;
    }
    if (below || above) return true;
  }
  return false;
}

}  // namespace

bool misses(const Camera& camera, double aspect, const Imath::Box3d& box) {
  if (box.intersects(camera.to_world.translation())) return false;
  const bool perspective = camera.projection == Camera::Projection::perspective;
  const double half_height = perspective ? std::tan(camera.vertical / 2) : camera.vertical;
  const double half_width = half_height * aspect;
  return is_beside_view(camera, half_width, half_height, box) ||
         is_beyond_face(view_edges(camera, half_width, half_height), box);
}

}  // namespace patchlight

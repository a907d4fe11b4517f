#include "pipeline/frames/camera_view.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace patchlight {

namespace {

constexpr int kCorners = 8, kEdges = 4;

/// What a camera sees, in its own frame: at depth d, x and y from `low` to `high`, in perspective times d, and on each
/// side `start` + `spread` d more by its lens.
struct View {
  bool perspective;
  Vec2d low, high;
  double start, spread;

  View(const Camera& camera, double aspect)
      : perspective(camera.projection == Camera::Projection::perspective),
        start(camera.aperture / 2),
        spread(camera.has_lens() ? camera.aperture / 2 / camera.focus : 0.0) {
    const double half_height = perspective ? std::tan(camera.vertical / 2) : camera.vertical;
    const Vec2d half(half_height * aspect, half_height);
    low = half * (camera.shift * 2.0 - Vec2d(1.0));
    high = half * (camera.shift * 2.0 + Vec2d(1.0));
  }

  /// How far a point is beyond the lower or the upper side along axis `k`.
  double beyond_low(const Vec3d& p, int k) const { return low[k] * scale(p) - margin(p) - p[k]; }
  double beyond_high(const Vec3d& p, int k) const { return p[k] - high[k] * scale(p) - margin(p); }

 private:
  double scale(const Vec3d& p) const { return perspective ? -p.z : 1.0; }
  double margin(const Vec3d& p) const { return start - spread * p.z; }
};

/// The four edges of a camera's view, each a point and a direction, in the world.
struct ViewEdges {
  std::array<Vec3d, kEdges> from{}, along{};
};

ViewEdges view_edges(const Camera& camera, const View& view) {
  ViewEdges edges;
  for (int i = 0; i < kEdges; ++i) {
    const bool right = i % 2 != 0, top = i / 2 != 0;
    const Vec3d side(right ? view.high.x : view.low.x, top ? view.high.y : view.low.y, 0);
    const Vec3d outward(right ? 1 : -1, top ? 1 : -1, 0);
    const Vec3d from = outward * view.start, along = Vec3d(0, 0, -1) + outward * view.spread;
    camera.to_world.multVecMatrix(view.perspective ? from : from + side, edges.from[i]);
    camera.to_world.multDirMatrix(view.perspective ? along + side : along, edges.along[i]);
  }
  return edges;
}

/// Whether a side of the view, or one of its clip planes, has the whole box behind it.
bool is_beside_view(const Camera& camera, const View& view, const Imath::Box3d& box) {
  const Matrix4 to_camera = camera.to_world.inverse();
  std::array<bool, 6> all_behind{true, true, true, true, true, true};
  for (int i = 0; i < kCorners; ++i) {
    const Vec3d corner(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z);
    Vec3d p;
    to_camera.multVecMatrix(corner, p);
    const std::array<double, 6> behind{view.beyond_low(p, 0),  view.beyond_high(p, 0), view.beyond_low(p, 1),
                                       view.beyond_high(p, 1), camera.znear + p.z,     -p.z - camera.zfar};
    for (std::size_t k = 0; k < behind.size(); ++k) all_behind[k] = all_behind[k] && behind[k] > 0;
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
  const View view(camera, aspect);
  return is_beside_view(camera, view, box) || is_beyond_face(view_edges(camera, view), box);
}

}  // namespace patchlight

#pragma once
#include "tests/patch_scene.h"

namespace patchlight::test {

inline constexpr int kFloorAcross = 12, kFloorDeep = 20;  // patches of the floor, which come first

/// A room of 3.2 x 2.5 x 5.6 m, its front at z = 0 open from (left, bottom) to (right, top).
inline PatchSet room_with_window(double left, double right, double bottom, double top, float reflectance = 0.0f) {
  PatchScene builder;
  const auto quad = [&](const std::array<Vec3d, 4>& corners, int nu, int nv) {
    builder.quad(corners, nu, nv, {reflectance});
  };
  quad({{{-1.6, 0, -5.6}, {-1.6, 0, 0}, {1.6, 0, 0}, {1.6, 0, -5.6}}}, kFloorDeep, kFloorAcross);
  quad({{{-1.6, 2.5, -5.6}, {1.6, 2.5, -5.6}, {1.6, 2.5, 0}, {-1.6, 2.5, 0}}}, 4, 4);
  quad({{{-1.6, 0, -5.6}, {1.6, 0, -5.6}, {1.6, 2.5, -5.6}, {-1.6, 2.5, -5.6}}}, 4, 4);
  quad({{{-1.6, 0, 0}, {-1.6, 0, -5.6}, {-1.6, 2.5, -5.6}, {-1.6, 2.5, 0}}}, 4, 4);
  quad({{{1.6, 0, -5.6}, {1.6, 0, 0}, {1.6, 2.5, 0}, {1.6, 2.5, -5.6}}}, 4, 4);
  const auto front = [&](double x0, double x1, double y0, double y1) {
    quad({{{x1, y0, 0}, {x0, y0, 0}, {x0, y1, 0}, {x1, y1, 0}}}, 2, 2);
  };
  front(-1.6, left, 0, 2.5);
  front(right, 1.6, 0, 2.5);
  front(left, right, 0, bottom);
  front(left, right, top, 2.5);
  PatchSet& scene = builder.get();
  Environment& sky = scene.environment.emplace();
  sky.texels.assign(1, Color(1.0f));
  sky.rows = 24;
  sky.cells.assign(2 * 24 * 24, Color(1.0f));
  return scene;
}

}  // namespace patchlight::test

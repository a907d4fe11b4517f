#pragma once
#include <cmath>

#include "pipeline/optics/sampling/random.h"
#include "tests/alpha_mask_scene.h"
#include "tests/patch_scene.h"

namespace patchlight::test {

/// A scene whose light is hard to find, as seen by a camera, in patches `fine` times as small.
struct LitScene {
  PatchScene builder;
  Camera camera;
  int fine;

  explicit LitScene(int fineness) : fine(fineness) { builder.get().materials[0].name = "white"; }

  void quad(const std::array<Vec3d, 4>& corners, int nu, int nv, float reflectance, float emission = 0) {
    builder.quad(corners, emission > 0 ? nu : nu * fine, emission > 0 ? nv : nv * fine, {reflectance, emission});
  }

  void double_sided(const std::array<Vec3d, 4>& c, int nu, int nv, float reflectance, float emission = 0) {
    const auto first = std::int32_t(builder.get().primitives.size());
    quad(c, nu, nv, reflectance, emission);
    quad({c[1], c[0], c[3], c[2]}, nu, nv, reflectance, emission);
    builder.get().primitives[first].back = first + 1;
    builder.get().primitives[first + 1].back = first;
  }

  /// Five walls of a room of 4 x 2.6 x 5 m, open at z = 0.
  void walls(float reflectance) {
    quad({{{-2, 0, -5}, {-2, 0, 0}, {2, 0, 0}, {2, 0, -5}}}, 20, 16, reflectance);
    quad({{{-2, 2.6, -5}, {2, 2.6, -5}, {2, 2.6, 0}, {-2, 2.6, 0}}}, 12, 14, reflectance);
    quad({{{-2, 0, -5}, {2, 0, -5}, {2, 2.6, -5}, {-2, 2.6, -5}}}, 12, 8, reflectance);
    quad({{{-2, 0, 0}, {-2, 0, -5}, {-2, 2.6, -5}, {-2, 2.6, 0}}}, 14, 8, reflectance);
    quad({{{2, 0, -5}, {2, 0, 0}, {2, 2.6, 0}, {2, 2.6, -5}}}, 14, 8, reflectance);
  }

  /// The front wall, but for a window.
  void window(double left, double right, double bottom, double top, float reflectance) {
    const auto part = [&](double x0, double x1, double y0, double y1) {
      if (x1 > x0 && y1 > y0) quad({{{x1, y0, 0}, {x0, y0, 0}, {x0, y1, 0}, {x1, y1, 0}}}, 5, 5, reflectance);
    };
    part(-2, left, 0, 2.6), part(right, 2, 0, 2.6), part(left, right, 0, bottom), part(left, right, top, 2.6);
  }

  void table(double x0, double x1, double z0, double z1, double height) {
    double_sided({{{x0, height, z1}, {x1, height, z1}, {x1, height, z0}, {x0, height, z0}}}, 6, 6, 0.5f);
  }

  void sky(float radiance) {
    PatchSet& scene = builder.get();
    scene.light_groups = {"light", "sky"};
    Environment& environment = scene.environment.emplace();
    environment.texels.assign(1, Color(radiance));
    environment.rows = 24;
    environment.cells.assign(2 * 24 * 24, Color(radiance));
    environment.light_group = 1;
  }

  void sun(const Vec3d& direction, float strength) {
    Light sun = light_at({0, 0, 0}, Light::Kind::sun);
    sun.direction = direction.normalized();
    sun.strength = Color(strength);
    sun.outer = 0.0047;
    builder.get().lights.push_back(sun);
  }

  void look(const Vec3d& from, const Vec3d& at, double degrees) {
    const Vec3d back = (from - at).normalized(), right = (Vec3d(0, 1, 0) % back).normalized(), up = back % right;
    for (int k = 0; k < 3; ++k) {
      camera.to_world.x[0][k] = right[k];
      camera.to_world.x[1][k] = up[k];
      camera.to_world.x[2][k] = back[k];
      camera.to_world.x[3][k] = from[k];
    }
    camera.vertical = degrees * kPi / 180;
  }
};

inline LitScene closed_room(int fine) {
  LitScene room(fine);
  room.walls(0.6f);
  room.window(0, 0, 0, 0, 0.6f);
  return room;
}

/// Sun and sky through a blind of ten slats of 12 cm, half closed.
inline LitScene blinds(int fine) {
  LitScene room(fine);
  room.walls(0.6f);
  room.window(-1, 1, 0.8, 2, 0.6f);
  for (int k = 0; k < 10; ++k) {
    const double y = 0.86 + 0.12 * k;
    room.double_sided({{{-1, y + 0.04, -0.05}, {-1, y - 0.04, -0.14}, {1, y - 0.04, -0.14}, {1, y + 0.04, -0.05}}}, 8,
                      2, 0.5f);
  }
  room.sky(1);
  room.sun({-0.3, -0.5, -1}, 20);
  room.look({1.6, 1.5, -4.7}, {-0.6, 0.8, 0}, 60);
  return room;
}

/// A lampshade of 48 double-sided segments that glow, and no other light.
inline LitScene lampshade(int fine) {
  LitScene room = closed_room(fine);
  constexpr int kSegments = 48;
  const auto at = [](int k, double y) {
    const double turn = 2 * kPi * k / kSegments;
    return Vec3d(0.25 * std::cos(turn), y, -2.5 - 0.25 * std::sin(turn));
  };
  for (int k = 0; k < kSegments; ++k)
    room.double_sided({{at(k, 1.6), at(k + 1, 1.6), at(k + 1, 1.9), at(k, 1.9)}}, 1, 1, 0.3f, 4.0f);
  room.table(-0.4, 0.4, -2.9, -2.1, 0.7);
  room.look({1.7, 1.7, -0.2}, {-0.3, 0.9, -3}, 60);
  return room;
}

/// A street of 80 round lamps on two sides, between facades.
inline LitScene street(int fine) {
  LitScene scene(fine);
  scene.quad({{{-5, 0, -80}, {-5, 0, 0}, {5, 0, 0}, {5, 0, -80}}}, 80, 10, 0.3f);
  scene.quad({{{-5, 0, 0}, {-5, 0, -80}, {-5, 9, -80}, {-5, 9, 0}}}, 60, 8, 0.5f);
  scene.quad({{{5, 0, -80}, {5, 0, 0}, {5, 9, 0}, {5, 9, -80}}}, 60, 8, 0.5f);
  for (int k = 0; k < 40; ++k)
    for (const double x : {-4.0, 4.0}) {
      const double z = -1 - 2 * k;
      scene.builder.sphere({x, 4, z}, 0.2, 1, 1, {0.0f, 30.0f});
      scene.double_sided({{{x - 0.05, 0, z}, {x + 0.05, 0, z}, {x + 0.05, 3.8, z}, {x - 0.05, 3.8, z}}}, 1, 8, 0.4f);
    }
  scene.look({1, 1.7, -0.5}, {-0.5, 2.5, -20}, 60);
  return scene;
}

/// A room that one window lights, by the sky alone.
inline LitScene window(int fine) {
  LitScene room(fine);
  room.walls(0.6f);
  room.window(-1.5, -0.5, 0.9, 2.1, 0.6f);
  room.table(0.2, 1.4, -3.8, -3, 0.8);
  room.sky(10);
  room.look({1.6, 1.6, -0.3}, {-0.5, 0.7, -4}, 65);
  return room;
}

/// A canopy of 400 single-sided leaves over a lawn, under the sky and the sun.
inline LitScene leaves(int fine) {
  LitScene scene(fine);
  scene.quad({{{-5, 0, -10}, {-5, 0, 0}, {5, 0, 0}, {5, 0, -10}}}, 30, 30, 0.3f);
  for (int k = 0; k < 400; ++k) {
    const auto at = [&](int n) { return uniform01(hash64(std::uint64_t(8 * k + n))); };
    const Vec3d middle(3 * at(0) - 1.5, 2 + at(1), -6.5 + 3 * at(2));
    const Vec3d normal = Vec3d(at(3) - 0.5, at(4) - 0.5, at(5) - 0.5).normalized();
    const Vec3d along = (normal % Vec3d(0.3, 1, 0.2)).normalized() * 0.12, across = (normal % along) * 0.6;
    scene.builder.quad(
        {middle - along - across, middle + along - across, middle + along + across, middle - along + across}, 1, 1,
        {0.4f});
  }
  scene.sky(1);
  scene.sun({-0.3, -1, -0.2}, 8);
  scene.look({2, 1.6, -0.5}, {-0.3, 1, -6}, 60);
  return scene;
}

/// Bodies without backs on a floor under the sky: cones that are open below, and a half sunk sphere.
inline LitScene cones(int fine) {
  LitScene scene(fine);
  scene.quad({{{-4, 0, -8}, {-4, 0, 0}, {4, 0, 0}, {4, 0, -8}}}, 30, 30, 0.5f);
  constexpr int kSegments = 16;
  for (const double x : {-1.2, 0.6}) {
    const auto at = [&](int k) {
      const double turn = 2 * kPi * k / kSegments;
      return Vec3d(x + 0.6 * std::cos(turn), 0.05, -4 - 0.6 * std::sin(turn));
    };
    const Vec3d top(x, 1.2, -4);
    for (int k = 0; k < kSegments; ++k) scene.quad({at(k), at(k + 1), top, top}, 2, 4, 0.6f);
  }
  scene.builder.sphere({1.9, 0.2, -3}, 0.5, 8 * fine, 16 * fine, {0.6f});
  scene.sky(1);
  scene.look({1.5, 1.8, -0.3}, {-0.2, 0.3, -4}, 60);
  return scene;
}

/// A room behind a sheet that a pattern of holes perforates, before a bright sky.
inline LitScene perforated(int fine) {
  LitScene room(fine);
  room.walls(0.6f);
  room.window(-1, 1, 0.8, 2, 0.6f);
  const auto first = int(room.builder.get().primitives.size());
  room.double_sided({{{-1.05, 0.75, 0.02}, {1.05, 0.75, 0.02}, {1.05, 2.05, 0.02}, {-1.05, 2.05, 0.02}}}, 6, 4, 0.5f);
  for (const int side : {first, first + 1}) alpha_masked(room.builder.get(), side, checkers(16), 0.5f);
  room.sky(10);
  room.look({1.6, 1.6, -4.6}, {-0.5, 0.9, 0}, 65);
  return room;
}

/// A room that a string of 150 bulbs lights.
inline LitScene bulbs(int fine) {
  LitScene room = closed_room(fine);
  for (int k = 0; k < 150; ++k) {
    const double t = k / 149.0, turn = 12 * t;
    room.builder.sphere({1.6 * std::cos(turn) * (1 - 0.5 * t), 2.3 - 0.4 * t, -2.5 + 1.8 * std::sin(turn)}, 0.02, 1, 1,
                        {0.0f, 40.0f});
  }
  room.table(-0.5, 0.5, -3, -2, 0.7);
  room.look({1.7, 1.5, -0.2}, {-0.4, 0.9, -3}, 65);
  return room;
}

/// A room that a strip of 200 diodes lights, under a shelf 20 cm from a wall.
inline LitScene strip(int fine) {
  LitScene room = closed_room(fine);
  room.double_sided({{{-1.2, 1.8, -4.7}, {1.2, 1.8, -4.7}, {1.2, 1.8, -5}, {-1.2, 1.8, -5}}}, 8, 2, 0.5f);
  for (int k = 0; k < 200; ++k) {
    const double x = -1 + 0.01 * k, z = -4.8;
    room.quad({{{x, 1.79, z}, {x + 0.008, 1.79, z}, {x + 0.008, 1.79, z + 0.01}, {x, 1.79, z + 0.01}}}, 1, 1, 0.1f, 60);
  }
  room.table(-0.6, 0.6, -5, -4.4, 0.8);
  room.look({1.5, 2.1, -1.5}, {-0.3, 1.1, -5}, 65);
  return room;
}

/// A dark room before a screen with a picture of 32 x 18 colours.
inline LitScene screen(int fine) {
  LitScene room = closed_room(fine);
  PatchSet& scene = room.builder.get();
  const std::size_t first = scene.patches.size();
  room.quad({{{-0.8, 0.9, -4.95}, {0.8, 0.9, -4.95}, {0.8, 1.8, -4.95}, {-0.8, 1.8, -4.95}}}, 32, 18, 0.05f, 1);
  for (std::size_t i = first; i < scene.patches.size(); ++i) {
    const auto x = float((i - first) % 32) / 31, y = float((i - first) / 32) / 17;
    const bool spot = std::hypot(x - 0.7f, y - 0.6f) < 0.12f;
    scene.patches[i].emission = spot ? Color(40, 35, 20) : Color(0.5f + 2 * x, 1, 3 - 2 * y);
  }
  room.look({1.6, 1.5, -1}, {-0.6, 0.7, -4.5}, 65);
  return room;
}

/// A square between facades with 10,000 lit windows at night.
inline LitScene city(int fine) {
  LitScene scene(fine);
  scene.quad({{{-30, 0, -60}, {-30, 0, 0}, {30, 0, 0}, {30, 0, -60}}}, 40, 40, 0.3f);
  const auto facade = [&](const Vec3d& from, const Vec3d& along, const Vec3d& out) {
    const Vec3d up(0, 75, 0);
    scene.quad({from, from + along, from + along + up, from + up}, 20, 25, 0.4f);
    for (int k = 0; k < 3334; ++k) {
      const Vec3d corner = from + along * ((k % 50 + 0.3) / 50) + Vec3d(0, 2 + (k / 50) * 1.08, 0) + out * 0.02;
      const Vec3d right = along.normalized() * 0.5, high(0, 0.6, 0);
      const float bright = 4 * uniform01(hash64(std::uint64_t(k))) * uniform01(hash64(std::uint64_t(k) + 7919));
      scene.builder.quad({corner, corner + right, corner + right + high, corner + high}, 1, 1, {0.1f, bright});
    }
  };
  facade({-30, 0, 0}, {0, 0, -60}, {1, 0, 0});
  facade({-30, 0, -60}, {60, 0, 0}, {0, 0, 1});
  facade({30, 0, -60}, {0, 0, 60}, {-1, 0, 0});
  scene.look({5, 8, -3}, {-8, 4, -50}, 65);
  return scene;
}

}  // namespace patchlight::test

#pragma once
#include "pipeline/job/job.h"
#include "pipeline/optics/sampling/random.h"
#include "tests/patch_scene.h"

namespace patchlight::test {

/// A room drawn at random, of 100 to 600 patches, and how it is solved: boxes, closed or with a wall left out in whole
/// or in part, some divided by a wall that leaves a slit; spheres; lamps, points of light and walls that glow unevenly;
/// a sky, a sun and a yard outside. Reflectances go from 0 to 0.99. The same seed gives the same room.
class RandomRoom {
 public:
  explicit RandomRoom(std::uint64_t seed) : random_(hash64(seed + 1)) {
    cells_ = 4 + pick(3);
    half_ = {uniform(0.7, 3), uniform(0.7, 1.5), uniform(0.7, 3)};
    reflectance_ = chance(0.5) ? uniform(0, 0.99) : 1 - std::pow(10.0, -uniform(0.5, 2));
    open_ = chance(0.4);
    add_walls();
    if (chance(0.3)) add_divider();
    for (int k = pick(3); k > 0; --k) add_sphere();
    if (open_) add_sky();
    if (!open_ || chance(0.5)) add_lights();
    config.rays = 16 << pick(7);
    config.tolerance = std::pow(10.0, -uniform(1, 5));
    config.seed = int(1 + seed);
    config.display = false;
  }

  const PatchSet& scene() { return builder_.get(); }

  /// Settings of a solve that is nearly exact on the same patches.
  SolveConfig exact() const {
    SolveConfig result = config;
    result.rays = 16384;
    result.tolerance = 1e-8;
    result.seed = config.seed + (1 << 20);
    return result;
  }

  SolveConfig config;

 private:
  double uniform(double low, double high) {
    random_ = hash64(random_ + 1);
    return low + (high - low) * double(random_ >> 11) * 0x1p-53;
  }
  int pick(int count) { return int(uniform(0, count)); }
  bool chance(double probability) { return uniform(0, 1) < probability; }

  /// Gives the last primitive a reflectance, in colour, that differs from those of the others.
  void paint() {
    PatchSet& scene = builder_.get();
    const bool dark = chance(0.1);
    Color color;
    for (int k = 0; k < 3; ++k) color[k] = float(dark ? uniform(0, 0.2) : reflectance_ * uniform(0.9, 1));
    const auto last = std::int32_t(scene.primitives.size()) - 1;
    for (Patch& patch : scene.patches)
      if (patch.primitive == last) patch.reflectance = color;
  }

  void add_quad(const Vec3d& middle, const Vec3d& u, const Vec3d& v, int nu, int nv, float emission = 0.0f) {
    builder_.quad({middle - u - v, middle + u - v, middle + u + v, middle - u + v}, nu, nv, {0.5f, emission});
    paint();
  }

  void add_walls() {
    const int open_wall = open_ ? pick(4) : -1;  // one of the walls in x or z
    const int glowing = chance(0.15) ? pick(6) : -1;
    for (int wall = 0; wall < 6; ++wall) {
      const int axis = std::array{0, 0, 2, 2, 1, 1}[wall], next = (axis + 1) % 3, last = (axis + 2) % 3;
      const double side = wall % 2 ? 1 : -1;
      Vec3d middle(0.0), u(0.0), v(0.0);
      middle[axis] = side * half_[axis];
      u[next] = half_[next];
      v[last] = -side * half_[last];
      if (wall != open_wall) {
        add_quad(middle, u, v, cells_, cells_);
        if (wall == glowing) glow();
        continue;
      }
      if (chance(0.6)) {  // a parapet below the window
        const double height = uniform(0.5, 0.95);
        middle[1] -= (1 - height) * half_[1];
        (next == 1 ? u : v) *= height;
        add_quad(middle, u, v, cells_, cells_);
      }
      if (chance(0.6)) {  // a yard before the room
        Vec3d yard(0.0), along(0.0), across(0.0);
        yard[axis] = side * 2 * half_[axis];
        yard[1] = -half_[1];
        along[axis] = side * half_[axis];
        across[2 - axis] = (axis == 0 ? -side : side) * 2 * half_[2 - axis];
        add_quad(yard, along, across, cells_, cells_);
      }
    }
  }

  /// Lets the last primitive emit unevenly, so that its light is gathered with the form factors.
  void glow() {
    PatchSet& scene = builder_.get();
    scene.primitives.back().light_group = 0;
    for (Patch& patch : scene.patches)
      if (&scene.primitives[patch.primitive] == &scene.primitives.back()) patch.emission = Color(float(uniform(0, 2)));
  }

  /// Two sides of a wall in the middle that ends below the ceiling.
  void add_divider() {
    const double top = half_[1] * uniform(0.2, 0.97);
    for (const double side : {-1.0, 1.0})
      add_quad({0.01 * side, 0.5 * (top - half_[1]), 0}, {0, 0.5 * (top + half_[1]), 0}, {0, 0, side * half_[2]}, 4, 4);
  }

  void add_sphere() {
    const double radius = uniform(0.1, 0.3);
    builder_.sphere(place_for_sphere(radius), radius, 5, 8, {0.5f});
    paint();
  }

  /// In a corner of the room of its own.
  Vec3d place_for_sphere(double radius) {
    Vec3d center;
    const int corner = spheres_++;
    for (int k = 0; k < 3; ++k)
      center[k] = (k == 0       ? corner % 2 ? 1 : -1
                   : k == 1     ? -1
                   : corner / 2 ? 1
                                : -1) *
                  uniform(radius + 0.02, half_[k] - radius - 0.02);
    return center;
  }

  void add_lights() {
    const int kind = pick(4);
    if (kind == 0) {
      builder_.get().lights.push_back(light_at({0.5 * half_[0], 0.8 * half_[1], uniform(-0.5, 0.5)}));
      return;
    }
    for (int k = 1 + pick(2); k > 0; --k) {
      if (kind == 1) {
        const double radius = uniform(0.05, 0.2);
        builder_.sphere(place_for_sphere(radius), radius, 3, 6, {0.3f, float(uniform(1, 20))});
        continue;
      }
      const double size = uniform(0.05, 0.3);
      add_quad({half_[0] * (k == 1 ? 0.4 : -0.4), 0.96 * half_[1], 0}, {size, 0, 0}, {0, 0, size}, 2, 2,
               float(uniform(1, 20)));
    }
  }

  void add_sky() {
    PatchSet& scene = builder_.get();
    scene.environment.emplace();
    scene.environment->rows = 4;
    scene.environment->texels.assign(1, Color(1.0f));
    const double horizon = uniform(0, 1);
    if (chance(0.5)) {
      scene.lights.push_back(light_at({0, 0, 0}, Light::Kind::sun));
      scene.lights.back().direction = Vec3d(uniform(-1, 1), -1, uniform(-1, 1)).normalized();
    }
    for (int cell = 0; cell < 32; ++cell)
      scene.environment->cells.push_back(Color(0.6f, 0.8f, 1.0f) * float(cell < 16 ? uniform(0.5, 1.5) : horizon));
  }

  std::uint64_t random_;
  int cells_ = 4, spheres_ = 0;
  Vec3d half_;
  double reflectance_ = 0;
  bool open_ = false;
  PatchScene builder_;
};

}  // namespace patchlight::test

#include "tests/bench/generated_scene.h"

#include <cmath>
#include <random>
#include <vector>

#include "tests/patch_scene.h"

namespace patchlight {

namespace {

/// A torus about the z axis with a rough surface.
struct RoughRing {
  Vec3d center{0.0};
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< Its axes, unit vectors.
  double radius = 1, tube_radius = 0.3;      ///< m
  bool inside = false;                       ///< Whether it is lit inside.
};

/// Factor of the tube's radius: octaves of waves of random phases.
class Roughness {
 public:
  explicit Roughness(std::mt19937& random) {
    std::uniform_real_distribution<double> turn(0, 2 * kPi);
    for (int octave = 0; octave < 6; ++octave)
      for (int k = 0; k < 3; ++k)
        waves_.push_back({3 << octave, (k - 1) << octave, 0.12 / (1 << octave), turn(random)});
  }

  double operator()(double along, double around) const {
    double sum = 1;
    for (const Wave& w : waves_) sum += w.height * std::sin(w.along * along + w.around * around + w.phase);
    return sum;
  }

 private:
  struct Wave {
    int along, around;
    double height, phase;
  };
  std::vector<Wave> waves_;
};

/// Adds a ring of `columns` x `rows` x 2 triangles.
void add_ring(const RoughRing& ring, int columns, int rows, std::mt19937& random, test::PatchScene& scene) {
  const Roughness roughness(random);
  std::vector<Vec3d> points;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      const double along = 2 * kPi * i / columns, around = 2 * kPi * j / rows;
      const double tube = ring.tube_radius * roughness(along, around);
      const Vec3d out = ring.x * std::cos(along) + ring.y * std::sin(along);
      points.push_back(ring.center + out * (ring.radius + tube * std::cos(around)) +
                       ring.z * (tube * std::sin(around)));
    }
  const auto at = [&](int i, int j) { return points[std::size_t(i % columns * rows + j % rows)]; };
  const auto add = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    if (ring.inside)
      scene.quad({a, c, b, b}, 1, 1, {});
    else
      scene.quad({a, b, c, c}, 1, 1, {});
  };
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      add(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
}

}  // namespace

PatchSet generated_cave(int triangles) {
  std::mt19937 random(1);
  test::PatchScene scene;
  const int rows = int(std::sqrt(triangles / 12.0));
  add_ring({.radius = 20, .tube_radius = 3, .inside = true}, 6 * rows, rows, random, scene);
  return std::move(scene.get());
}

PatchSet generated_rings(int triangles) {
  constexpr double kHalf = 10;  // m
  constexpr int kColumns = 50, kRows = 20;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-0.93 * kHalf, 0.93 * kHalf), size(0.25, 0.5);
  std::normal_distribution<double> normal;
  test::PatchScene scene;
  scene.room(kHalf, 10, {});
  for (int k = 0; k < triangles / (2 * kColumns * kRows); ++k) {
    RoughRing ring;
    ring.center = {place(random), place(random), place(random)};
    ring.z = Vec3d(normal(random), normal(random), normal(random)).normalized();
    ring.x = (ring.z % Vec3d(normal(random), normal(random), normal(random))).normalized();
    ring.y = ring.z % ring.x;
    ring.radius = size(random);
    ring.tube_radius = 0.3 * ring.radius;
    add_ring(ring, kColumns, kRows, random, scene);
  }
  return std::move(scene.get());
}

}  // namespace patchlight

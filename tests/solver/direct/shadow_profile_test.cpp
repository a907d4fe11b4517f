#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "solver/solve.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

struct Box {
  Vec3d low, high;

  bool is_between(const Vec3d& a, const Vec3d& b) const {
    double enters = 0, leaves = 1;
    for (int k = 0; k < 3; ++k) {
      const double d = b[k] - a[k];
      if (d == 0 && (a[k] < low[k] || a[k] > high[k])) return false;
      if (d == 0) continue;
      const double p = (low[k] - a[k]) / d, q = (high[k] - a[k]) / d;
      enters = std::max(enters, std::min(p, q));
      leaves = std::min(leaves, std::max(p, q));
    }
    return enters < leaves;
  }

  bool covers(const Vec3d& p) const { return low.y <= 0 && p.x > low.x && p.x < high.x && p.z > low.z && p.z < high.z; }

  void add_to(PatchScene& builder) const {
    const auto side = [&](int a, int b, int c, int d) {
      const auto corner = [&](int k) {
        return Vec3d(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z);
      };
      builder.quad({corner(a), corner(b), corner(c), corner(d)}, 1, 1, {0.0f});
    };
    side(0, 4, 6, 2), side(1, 3, 7, 5), side(0, 1, 5, 4), side(2, 6, 7, 3), side(0, 2, 3, 1), side(4, 5, 7, 6);
  }
};

constexpr int kCells = 40;
constexpr double kHalfFloor = 2, kHalfLamp = 0.25, kLampHeight = 2;

/// Mean direct light of a patch of the floor by midpoint quadrature, for an exitance of 1; 0 under a box.
double quadrature(const Patch& patch, const std::vector<Box>& boxes) {
  constexpr int kPoints = 8, kLampPoints = 24;
  constexpr double kPiece = 2 * kHalfLamp / kLampPoints, kSize = 2 * kHalfFloor / kCells;
  double sum = 0;
  int count = 0;
  for (int i = 0; i < kPoints * kPoints; ++i) {
    const auto place = [&](int k) { return ((k + 0.5) / kPoints - 0.5) * kSize; };
    const Vec3d at = patch.center + Vec3d(place(i % kPoints), 0, place(i / kPoints));
    if (std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) { return box.covers(at); })) continue;
    ++count;
    for (int j = 0; j < kLampPoints * kLampPoints; ++j) {
      const Vec3d lamp((j % kLampPoints + 0.5) * kPiece - kHalfLamp, kLampHeight,
                       (j / kLampPoints + 0.5) * kPiece - kHalfLamp);
      if (std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) { return box.is_between(at, lamp); })) continue;
      const double squared = (lamp - at).length2();
      sum += kLampHeight * kLampHeight / (squared * squared * kPi) * kPiece * kPiece;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

/// The profile of direct light on a floor of 10 cm patches under a lamp of 50 cm, at default settings.
struct Profile {
  std::vector<double> want, got;

  explicit Profile(const std::vector<Box>& boxes) {
    PatchScene builder;
    const double f = kHalfFloor, l = kHalfLamp, h = kLampHeight;
    builder.quad({{{-f, 0, -f}, {-f, 0, f}, {f, 0, f}, {f, 0, -f}}}, kCells, kCells, {0.0f});
    builder.quad({{{-l, h, -l}, {l, h, -l}, {l, h, l}, {-l, h, l}}}, 1, 1, {0.0f, 1.0f});
    for (const Box& box : boxes) box.add_to(builder);
    SolveConfig config;
    config.display = false;
    Progress progress({"test", true, ""});
    const EnergyField energy = solve(builder.get(), config, progress);
    for (int i = 0; i < kCells * kCells; ++i) {
      want.push_back(quadrature(builder.get().patches[i], boxes));
      got.push_back(energy.groups[0].direct[i].y);
    }
  }

  /// Root mean square of the relative error of patches that get more than a part of the most.
  double relative_rms(double part) const {
    const double least = part * *std::max_element(want.begin(), want.end());
    double squares = 0;
    int count = 0;
    for (std::size_t i = 0; i < want.size(); ++i) {
      if (want[i] <= least) continue;
      squares += std::pow(got[i] / want[i] - 1, 2);
      ++count;
    }
    return std::sqrt(squares / count);
  }

  double rms() const {
    double squares = 0, all = 0;
    for (std::size_t i = 0; i < want.size(); ++i) {
      squares += std::pow(got[i] - want[i], 2);
      all += want[i] * want[i];
    }
    return std::sqrt(squares / all);
  }
};

TEST(ShadowProfile, BlockOnAFloor) {
  const Profile profile({{{-0.3, 0, -0.3}, {0.3, 0.6, 0.3}}});
  EXPECT_LT(profile.relative_rms(0), 0.01);
}

TEST(ShadowProfile, SlitBetweenThickBoards) {
  const Profile profile({{{-2, 0.8, -2}, {-0.1, 1.1, 2}}, {{0.1, 0.8, -2}, {2, 1.1, 2}}});
  EXPECT_LT(profile.rms(), 0.02);
  EXPECT_LT(profile.relative_rms(0.1), 0.02);
}

}  // namespace
}  // namespace patchlight

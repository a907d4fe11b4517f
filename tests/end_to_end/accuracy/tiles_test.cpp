#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "importers/patches/patch_cuts.h"
#include "solver/solve.h"
#include "tests/end_to_end/accuracy/light_scenes.h"
#include "tracer/light/solution/solved_surfaces.h"

namespace patchlight::test {
namespace {

/// A floor of 4 x 4 m, split into tiles, with a block on it, a bright wall, a lamp and a sky. Irradiance of the floor
/// under the whole solution.
class Floor {
 public:
  /// `across`: number of tiles along a side. `turned`: whether their corners begin at different places. `finer`: their
  /// numbers of cells, over those of equal ones, in turn.
  Floor(int across, bool turned, const std::vector<double>& finer = {1}) : across_(across), lit_(1) {
    const double size = 4.0 / across;
    for (int k = 0; k < across * across; ++k) {
      const double x = -2 + k % across * size, z = -2 + k / across * size;
      std::array<Vec3d, 4> c{{{x, 0, z}, {x, 0, z + size}, {x + size, 0, z + size}, {x + size, 0, z}}};
      if (turned) std::rotate(c.begin(), c.begin() + k % 4, c.end());
      const auto cells = int(32 / across * finer[std::size_t(k + k / across) % finer.size()]);
      lit_.quad(c, cells, cells, 0.6f);
    }
    const std::array<Vec3d, 5> foot{{{-0.4, 0, 0.1}, {0.3, 0, 0.1}, {0.3, 0, -0.6}, {-0.4, 0, -0.6}, {-0.4, 0, 0.1}}};
    for (int k = 0; k < 4; ++k)
      lit_.quad({{foot[k], foot[k + 1], foot[k + 1] + Vec3d(0, 0.7, 0), foot[k] + Vec3d(0, 0.7, 0)}}, 5, 5, 0.5f);
    lit_.quad({{{-2, 0, -2}, {2, 0, -2}, {2, 2, -2}, {-2, 2, -2}}}, 16, 8, 0.7f);
    lit_.quad({{{0.9, 1.8, 0.6}, {1.3, 1.8, 0.6}, {1.3, 1.8, 1}, {0.9, 1.8, 1}}}, 1, 1, 0, 20);
    lit_.sky(0.3f);
    PatchSet& scene = lit_.builder.get();
    cut_patches(std::vector<PatchTarget>(scene.primitives.size(), {1.0 / 64}), scene);
    Progress progress({"test", true, ""});
    Transport transport;
    energy_ = solve(scene, SolveConfig(), transport, progress);
    surfaces_.emplace(scene, energy_, mixes_, config_, SmoothEdges(scene.primitives));
  }

  double at(double x, double z) const {
    const auto tile = [&](double p) { return std::clamp(int(std::floor((p + 2) * across_ / 4)), 0, across_ - 1); };
    const PatchSet& scene = lit_.builder.get();
    const std::int32_t i = tile(z) * across_ + tile(x);
    const Vec2f uv(uv_of(scene.primitives[i], {x, 0, z}));
    SurfaceHit hit;
    hit.primitive = i;
    hit.front = true;
    hit.u = uv.x;
    hit.v = uv.y;
    return surfaces_->irradiance(hit, surfaces_->blend(hit, surfaces_->colors(hit).patch)).x;
  }

 private:
  const int across_;
  mutable LitScene lit_;
  EnergyField energy_;
  const TraceConfig config_;
  const LightMixes mixes_{{Color(1.0f), Color(1.0f)}, false};
  std::optional<SolvedSurfaces> surfaces_;
};

/// Whether a point lies under the block or at its foot.
bool is_at_the_block(double x, double z) {
  return x > -0.41 && x < 0.31 && z > -0.61 && z < 0.11;
}

/// Relative steps at the seams of a floor's tiles, away from the block.
struct Steps {
  double mean = 0, largest = 0;

  explicit Steps(const Floor& floor, int across) {
    int count = 0;
    for (int k = 1; k < across; ++k)
      for (double z = -1.987; z < 2; z += 0.05) {
        const double x = -2 + k * 4.0 / across;
        const auto add = [&](double before, double behind) {
          mean += std::abs(std::log(behind / before));
          largest = std::max(largest, std::abs(std::log(behind / before)));
          ++count;
        };
        if (!is_at_the_block(x, z)) add(floor.at(x - 1e-5, z), floor.at(x + 1e-5, z));
        if (!is_at_the_block(z, x)) add(floor.at(z, x - 1e-5), floor.at(z, x + 1e-5));
      }
    mean /= count;
  }
};

TEST(Tiles, OfAFloorHaveNoSeams) {
  for (const bool turned : {false, true})
    for (const int across : {2, 4, 32}) {
      const Steps steps(Floor(across, turned), across);
      EXPECT_LT(steps.mean, 0.001) << across;
      EXPECT_LT(steps.largest, 0.1) << across;
    }
}

TEST(Tiles, WithCellsOfDifferentSizesHaveNoSeams) {
  for (const bool turned : {false, true})
    for (const int across : {2, 4}) {
      const Steps steps(Floor(across, turned, {1, 0.5, 2, 0.25}), across);
      EXPECT_LT(steps.mean, 0.001) << across;
      EXPECT_LT(steps.largest, 0.1) << across;
    }
}

TEST(Tiles, WhoseCellsDoNotLineUpHaveFaintSeams) {
  for (const auto& finer : {std::vector{1.0, 0.75}, {1.0, 1.25, 0.875}}) {
    const Steps steps(Floor(4, true, finer), 4);
    EXPECT_LT(steps.mean, 0.02);
    EXPECT_LT(steps.largest, 0.2);
  }
}

TEST(Tiles, AreAsOneSurface) {
  const Floor whole(1, false), tiles(8, true);
  double squares = 0, bias = 0;
  int count = 0;
  for (double x = -1.97; x < 2; x += 0.06)
    for (double z = -1.97; z < 2; z += 0.06) {
      if (is_at_the_block(x, z)) continue;
      const double ratio = tiles.at(x, z) / whole.at(x, z) - 1;
      squares += ratio * ratio;
      bias += ratio;
      ++count;
    }
  EXPECT_LT(std::sqrt(squares / count), 0.03);
  EXPECT_LT(std::abs(bias / count), 0.003);
}

}  // namespace
}  // namespace patchlight::test

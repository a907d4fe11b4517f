#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "importers/patches/patch_cuts.h"
#include "solver/solve.h"
#include "tests/end_to_end/accuracy/light_scenes.h"
#include "tracer/light/integrator.h"

namespace patchlight::test {
namespace {

constexpr double kLimit = 1e-4;  ///< Of the brightest pixel of the dark side, over the mean of the lit one.
constexpr double kLimitOfHemicubes = 2.5e-4;  ///< The same; a rasterizer rounds the feet of walls to parts of a cell.

/// A scene of two spaces that share surfaces. A lamp lights the one on the left of x = 0; the other must stay dark.
struct Case {
  const char* name;
  void (*build)(LitScene&);

  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
};

/// Six faces of a box, lit inside or outside.
void box(LitScene& lit, const Vec3d& a, const Vec3d& b, bool outside, int cells) {
  const auto face = [&](Vec3d p, Vec3d q, Vec3d r, Vec3d s) {
    lit.quad(outside ? std::array<Vec3d, 4>{s, r, q, p} : std::array<Vec3d, 4>{p, q, r, s}, cells, cells, 0.7f);
  };
  face({a.x, a.y, b.z}, {b.x, a.y, b.z}, {b.x, a.y, a.z}, {a.x, a.y, a.z});
  face({a.x, b.y, a.z}, {b.x, b.y, a.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z});
  face({a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, b.y, a.z}, {a.x, b.y, a.z});
  face({b.x, a.y, b.z}, {a.x, a.y, b.z}, {a.x, b.y, b.z}, {b.x, b.y, b.z});
  face({a.x, a.y, b.z}, {a.x, a.y, a.z}, {a.x, b.y, a.z}, {a.x, b.y, b.z});
  face({b.x, a.y, a.z}, {b.x, a.y, b.z}, {b.x, b.y, b.z}, {b.x, b.y, a.z});
}

void lamp(LitScene& lit) {
  lit.quad({{{-2.5, 2.6, -0.5}, {-1.5, 2.6, -0.5}, {-1.5, 2.6, 0.5}, {-2.5, 2.6, 0.5}}}, 1, 1, 0, 30);
}

void shell(LitScene& lit) {
  box(lit, {-4, 0, -1.5}, {4, 2.7, 1.5}, false, 13);
  lamp(lit);
}

/// The shell with a floor and a ceiling of four tiles each, whose corners begin at different places. `shapes`: of their
/// grids, in turn.
void tiled_shell(LitScene& lit, const std::vector<std::array<int, 2>>& shapes = {{12, 6}}) {
  const auto tile = [&](std::array<Vec3d, 4> c, int turn) {
    std::rotate(c.begin(), c.begin() + turn, c.end());
    const auto [nu, nv] = shapes[std::size_t(turn) % shapes.size()];
    lit.quad(c, turn % 2 == 0 ? nu : nv, turn % 2 == 0 ? nv : nu, 0.7f);
  };
  int turn = 0;
  for (const double x : {-4.0, 0.0})
    for (const double z : {0.0, 1.5}) {
      tile({{{x, 0, z}, {x + 4, 0, z}, {x + 4, 0, z - 1.5}, {x, 0, z - 1.5}}}, turn);
      tile({{{x, 2.7, z - 1.5}, {x + 4, 2.7, z - 1.5}, {x + 4, 2.7, z}, {x, 2.7, z}}}, turn++);
    }
  for (const double x : {-4.0, 4.0}) {
    const double z = x < 0 ? 1.5 : -1.5;
    lit.quad({{{x, 0, z}, {x, 0, -z}, {x, 2.7, -z}, {x, 2.7, z}}}, 6, 6, 0.7f);
  }
  for (const double z : {-1.5, 1.5}) {
    const double x = z < 0 ? -4 : 4;
    lit.quad({{{x, 0, z}, {-x, 0, z}, {-x, 2.7, z}, {x, 2.7, z}}}, 24, 6, 0.7f);
  }
  lamp(lit);
}

/// A round tower of 48 facets about (2, 0), from the floor to the ceiling.
void tower(LitScene& lit, double radius, bool outside) {
  constexpr int kFacets = 48;
  const auto at = [&](int k, double y) {
    const double angle = 2 * kPi * k / kFacets;
    return Vec3d(2 + radius * std::cos(angle), y, -radius * std::sin(angle));
  };
  for (int k = 0; k < kFacets; ++k) {
    const std::array<Vec3d, 4> facet{at(k, 0), at(k + 1, 0), at(k + 1, 2.7), at(k, 2.7)};
    lit.quad(outside ? facet : std::array<Vec3d, 4>{facet[1], facet[0], facet[3], facet[2]}, 1, 6, 0.7f);
  }
}

/// Two closed boxes without tops under one roof that overlaps their walls, on a common floor.
void roof(LitScene& lit, double overlap) {
  lit.quad({{{-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, {-5, 0, -5}}}, 13, 13, 0.7f);
  const double out = overlap;
  lit.quad({{{-4 - out, 2.7, -1.5 - out},
             {4 + out, 2.7, -1.5 - out},
             {4 + out, 2.7, 1.5 + out},
             {-4 - out, 2.7, 1.5 + out}}},
           13, 7, 0.7f);
  for (const double x : {-4.0, 4.0, 0.0})
    lit.double_sided({{{x, 0, 1.5}, {x, 0, -1.5}, {x, 2.7, -1.5}, {x, 2.7, 1.5}}}, 7, 6, 0.7f);
  for (const double z : {-1.5, 1.5})
    lit.double_sided({{{-4, 0, z}, {4, 0, z}, {4, 2.7, z}, {-4, 2.7, z}}}, 13, 6, 0.7f);
  lamp(lit);
}

const Case kCases[]{
    {"sheet",
     [](LitScene& lit) {
       shell(lit);
       lit.double_sided({{{0, 0, 1.5}, {0, 0, -1.5}, {0, 2.7, -1.5}, {0, 2.7, 1.5}}}, 6, 5, 0.7f);
     }},
    {"sheet_between_tiles",
     [](LitScene& lit) {
       tiled_shell(lit);
       lit.double_sided({{{0, 0, 1.5}, {0, 0, -1.5}, {0, 2.7, -1.5}, {0, 2.7, 1.5}}}, 6, 5, 0.7f);
     }},
    {"wall_across_tiles",
     [](LitScene& lit) {
       tiled_shell(lit);
       box(lit, {-0.15, 0, -1.5}, {-0.05, 2.7, 1.5}, true, 8);
     }},
    {"sheet_between_uneven_tiles",
     [](LitScene& lit) {
       tiled_shell(lit, {{12, 6}, {6, 3}, {24, 12}});
       lit.double_sided({{{0, 0, 1.5}, {0, 0, -1.5}, {0, 2.7, -1.5}, {0, 2.7, 1.5}}}, 6, 5, 0.7f);
     }},
    {"wall_across_uneven_tiles",
     [](LitScene& lit) {
       tiled_shell(lit, {{6, 3}, {12, 6}, {7, 5}});
       box(lit, {-0.05, 0, -1.5}, {0, 2.7, 1.5}, true, 8);
     }},
    {"slanted_sheet",
     [](LitScene& lit) {
       shell(lit);
       lit.double_sided({{{-0.4, 0, 1.5}, {0, 0, -1.5}, {0, 2.7, -1.5}, {-0.4, 2.7, 1.5}}}, 6, 5, 0.7f);
     }},
    {"sunk_wall",
     [](LitScene& lit) {
       shell(lit);
       box(lit, {-0.15, -0.05, -1.55}, {-0.05, 2.75, 1.55}, true, 8);
     }},
    {"standing_wall",
     [](LitScene& lit) {
       shell(lit);
       box(lit, {-0.15, 0, -1.5}, {-0.05, 2.7, 1.5}, true, 8);
     }},
    {"round_tower",
     [](LitScene& lit) {
       shell(lit);
       tower(lit, 1.2, true);
       tower(lit, 1.1, false);
     }},
    {"roof", [](LitScene& lit) { roof(lit, 0); }},
    {"roof_1mm", [](LitScene& lit) { roof(lit, 0.001); }},
    {"roof_1cm", [](LitScene& lit) { roof(lit, 0.01); }},
};

class Walls : public ::testing::TestWithParam<Case> {
 protected:
  /// The scene, turned about the vertical, with its surfaces cut.
  static LitScene scene(double turn) {
    LitScene lit(1);
    GetParam().build(lit);
    PatchSet& set = lit.builder.get();
    const Vec3d x(std::cos(turn), 0, -std::sin(turn)), z(std::sin(turn), 0, std::cos(turn));
    const auto turned = [&](const Vec3d& p) { return x * p.x + Vec3d(0, p.y, 0) + z * p.z; };
    for (Primitive& p : set.primitives)
      for (Vec3d& corner : p.corners) corner = turned(corner);
    for (Patch& patch : set.patches) {
      patch.center = turned(patch.center);
      patch.normal = Vec3f(turned(Vec3d(patch.normal)));
    }
    cut_patches(std::vector<PatchTarget>(set.primitives.size(), {0.06}), set);
    lit.look(turned({dark() ? Vec3d(2.9, 1.4, 0.2) : Vec3d(-3.7, 1.7, 1.2)}),
             turned(dark() ? Vec3d(1.2, 0.9, -0.3) : Vec3d(-0.5, 0.8, -0.8)), 70);
    return lit;
  }

  static bool& dark() {
    static bool is_dark = false;
    return is_dark;
  }

  /// The largest and the mean value of a frame of the lit or of the dark side.
  static std::pair<double, double> frame(bool of_dark, double turn, const SolveConfig& solve_config) {
    dark() = of_dark;
    const LitScene lit = scene(turn);
    Progress progress({"test", true, ""});
    Job job;
    job.trace.resolution = {48, 36};
    job.trace.samples = 4;
    Transport transport;
    LitScene copy = lit;
    const Image image =
        Integrator(copy.builder.get(), solve(copy.builder.get(), solve_config, transport, progress), job)
            .render(lit.camera, progress);
    double largest = 0, sum = 0;
    for (const Color& pixel : image.pixels) {
      largest = std::max(largest, double(pixel.x));
      sum += pixel.x;
    }
    return {largest, sum / double(image.pixels.size())};
  }
};

TEST_P(Walls, LetNoLightThrough) {
  SolveConfig config;
  config.rays = 128;
  for (const char* method : {"matrix", "progressive"})
    for (const double turn : {0.0, 0.3}) {
      config.method = method;
      const double lit = frame(false, turn, config).second;
      EXPECT_GT(lit, 0.1);
      EXPECT_LT(frame(true, turn, config).first, kLimit * lit) << method << " " << turn;
    }
}

TEST_P(Walls, LetHardlyAnyLightThroughByHemicubes) {
  SolveConfig config;
  config.form_factors = "hemicube";
  const double lit = frame(false, 0, config).second;
  EXPECT_GT(lit, 0.1);
  EXPECT_LT(frame(true, 0, config).first, kLimitOfHemicubes * lit);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Walls, ::testing::ValuesIn(kCases), [](const auto& of) { return of.param.name; });

}  // namespace
}  // namespace patchlight::test

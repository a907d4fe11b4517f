#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "pipeline/image/image_file.h"
#include "solver/solve.h"
#include "tests/patch_scene.h"
#include "tracer/light/integrator.h"

namespace patchlight::test {
namespace {

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
    quad({c[0], c[3], c[2], c[1]}, nv, nu, reflectance, emission);
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

  void sky(float radiance) {
    PatchSet& scene = builder.get();
    scene.light_groups = {"light", "sky"};
    Environment& environment = scene.environment.emplace();
    environment.texels.assign(1, Color(radiance));
    environment.rows = 24;
    environment.cells.assign(2 * 24 * 24, Color(radiance));
    environment.light_group = 1;
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

/// Sun and sky through a blind of ten slats of 12 cm, half closed.
LitScene blinds(int fine) {
  LitScene room(fine);
  room.walls(0.6f);
  room.window(-1, 1, 0.8, 2, 0.6f);
  for (int k = 0; k < 10; ++k) {
    const double y = 0.86 + 0.12 * k;
    room.double_sided({{{-1, y + 0.04, -0.05}, {-1, y - 0.04, -0.14}, {1, y - 0.04, -0.14}, {1, y + 0.04, -0.05}}}, 8,
                      2, 0.5f);
  }
  room.sky(1);
  Light sun = light_at({0, 0, 0}, Light::Kind::sun);
  sun.direction = Vec3d(-0.3, -0.5, -1).normalized();
  sun.strength = Color(20.0f);
  sun.outer = 0.0047;
  room.builder.get().lights.push_back(sun);
  room.look({1.6, 1.5, -4.7}, {-0.6, 0.8, 0}, 60);
  return room;
}

/// A lampshade of 48 double-sided segments that glow, and no other light.
LitScene lampshade(int fine) {
  LitScene room(fine);
  room.walls(0.6f);
  room.window(0, 0, 0, 0, 0.6f);
  constexpr int kSegments = 48;
  const auto at = [](int k, double y) {
    const double turn = 2 * kPi * k / kSegments;
    return Vec3d(0.25 * std::cos(turn), y, -2.5 - 0.25 * std::sin(turn));
  };
  for (int k = 0; k < kSegments; ++k)
    room.double_sided({{at(k, 1.6), at(k + 1, 1.6), at(k + 1, 1.9), at(k, 1.9)}}, 1, 1, 0.3f, 4.0f);
  room.quad({{{-0.4, 0.7, -2.1}, {0.4, 0.7, -2.1}, {0.4, 0.7, -2.9}, {-0.4, 0.7, -2.9}}}, 6, 6, 0.5f);
  room.quad({{{-0.4, 0.7, -2.9}, {0.4, 0.7, -2.9}, {0.4, 0.7, -2.1}, {-0.4, 0.7, -2.1}}}, 6, 6, 0.5f);
  room.look({1.7, 1.7, -0.2}, {-0.3, 0.9, -3}, 60);
  return room;
}

/// A street of 80 round lamps on two sides, between facades.
LitScene street(int fine) {
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
LitScene window(int fine) {
  LitScene room(fine);
  room.walls(0.6f);
  room.window(-1.5, -0.5, 0.9, 2.1, 0.6f);
  room.quad({{{0.2, 0.8, -3}, {1.4, 0.8, -3}, {1.4, 0.8, -3.8}, {0.2, 0.8, -3.8}}}, 6, 4, 0.5f);
  room.quad({{{0.2, 0.8, -3.8}, {1.4, 0.8, -3.8}, {1.4, 0.8, -3}, {0.2, 0.8, -3}}}, 4, 6, 0.5f);
  room.sky(10);
  room.look({1.6, 1.6, -0.3}, {-0.5, 0.7, -4}, 65);
  return room;
}

struct Kind {
  const char* name;
  LitScene (*make)(int fine);
  double pixels, blocks;  ///< Largest errors.
};

class LightFrames : public ::testing::TestWithParam<Kind> {
 protected:
  static constexpr int kBlock = 6;  // pixels

  static Image render(LitScene lit, const SolveConfig& config, const TraceConfig& trace) {
    const PatchSet& scene = lit.builder.get();
    Progress progress({"test", true, ""});
    Job job;
    job.trace = trace;
    job.trace.resolution = {96, 72};
    return Integrator(scene, solve(scene, config, progress), job).render(lit.camera, progress);
  }

  std::filesystem::path reference() const {
    return std::string(PATCHLIGHT_SOURCE) + "/tests/end_to_end/golden/light/" + GetParam().name + ".exr";
  }

  /// Root mean square of the difference between means of blocks of pixels, over that of the reference.
  static double error(const Image& image, const Image& exact, int block) {
    double squares = 0, all = 0;
    for (int y = 0; y < image.height; y += block)
      for (int x = 0; x < image.width; x += block) {
        Vec3d difference(0.0), sum(0.0);
        for (int k = 0; k < block * block; ++k) {
          const std::size_t at = std::size_t(y + k / block) * image.width + x + k % block;
          difference += Vec3d(image.pixels[at]) - Vec3d(exact.pixels[at]);
          sum += Vec3d(exact.pixels[at]);
        }
        squares += difference.length2();
        all += sum.length2();
      }
    return std::sqrt(squares / all);
  }
};

/// Makes the references, by many rays and small patches, in five minutes:
/// `end_to_end_test --gtest_also_run_disabled_tests --gtest_filter='*MakeReference*'`.
TEST_P(LightFrames, DISABLED_MakeReference) {
  SolveConfig config;
  config.rays = 8192;
  config.tolerance = 1e-5;
  TraceConfig trace;
  trace.quality = "gather";
  trace.samples = 256;
  trace.gather_rays = 64;
  std::filesystem::create_directories(reference().parent_path());
  write_exr(reference(), render(GetParam().make(2), config, trace));
}

TEST_P(LightFrames, AreRightAtDefaultSettings) {
  const Image exact = read_exr(reference()), image = render(GetParam().make(1), {}, {});
  EXPECT_LT(error(image, exact, 1), GetParam().pixels);
  EXPECT_LT(error(image, exact, kBlock), GetParam().blocks);
}

INSTANTIATE_TEST_SUITE_P(Scenes, LightFrames,
                         ::testing::Values(Kind{"blinds", blinds, 0.08, 0.02},
                                           Kind{"lampshade", lampshade, 0.012, 0.004},
                                           Kind{"street", street, 0.035, 0.012}, Kind{"window", window, 0.03, 0.02}),
                         [](const auto& kind) { return std::string(kind.param.name); });

}  // namespace
}  // namespace patchlight::test

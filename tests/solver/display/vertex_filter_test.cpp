#include "solver/display/vertex_filter.h"

#include <gtest/gtest.h>

#include <functional>

#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/transport/face_lookup.h"
#include "tests/solver/display/display_scenes.h"

namespace patchlight::test {
namespace {

/// Irradiance at vertices by two sample sets with noise of their own.
struct Sampled {
  SpectrumField exact, mean, deviation;

  Sampled(const PatchSet& scene, const DisplayMesh& mesh, double noise,
          const std::function<double(const Vec3d&)>& irradiance) {
    const std::vector<Patch> points = vertex_patches(scene, mesh);
    for (std::size_t i = 0; i < points.size(); ++i) {
      exact.emplace_back(irradiance(points[i].center));
      const double a = noise * (uniform01(hash64(2 * std::uint64_t(i))) - 0.5);
      const double b = noise * (uniform01(hash64(2 * std::uint64_t(i) + 1)) - 0.5);
      mean.push_back(exact.back() + Spectrum(0.5 * (a + b)));
      deviation.emplace_back(0.5 * (a - b));
    }
  }

  /// Mean squared error.
  double error(const SpectrumField& field) const {
    double sum = 0;
    for (std::size_t i = 0; i < field.size(); ++i) {
      const Spectrum difference = field[i] - exact[i];
      sum += (difference * difference).sum();
    }
    return sum / double(field.size());
  }
};

TEST(VertexFilter, TakesNoiseAwayWhereLightIsEven) {
  PatchScene builder;
  builder.room(1, 8, {0.5f, 0.0f});
  const DisplayMesh mesh = mesh_of(builder.get());
  const Sampled sampled(builder.get(), mesh, 0.2, [](const Vec3d&) { return 1.0; });
  const SpectrumField filtered = VertexFilter(builder.get(), mesh).apply(sampled.mean, sampled.deviation);
  EXPECT_LT(sampled.error(filtered), 0.4 * sampled.error(sampled.mean));
}

TEST(VertexFilter, KeepsGradientsAndExactValues) {
  PatchScene builder;
  builder.room(1, 8, {0.5f, 0.0f});
  const DisplayMesh mesh = mesh_of(builder.get());
  const auto gradient = [](const Vec3d& p) { return 5 + p.x + 2 * p.y - p.z; };
  const Sampled sampled(builder.get(), mesh, 0.2, gradient), exact(builder.get(), mesh, 0.0, gradient);
  const VertexFilter filter(builder.get(), mesh);
  EXPECT_LT(sampled.error(filter.apply(sampled.mean, sampled.deviation)), 0.5 * sampled.error(sampled.mean));
  EXPECT_LT(exact.error(filter.apply(exact.mean, exact.deviation)), 1e-12);
}

TEST(VertexFilter, KeepsWhatVariesMoreThanItsNoise) {
  PatchScene builder;
  builder.room(1, 8, {0.5f, 0.0f});
  const DisplayMesh mesh = mesh_of(builder.get());
  const auto ripples = [](const Vec3d& p) {
    return 2 + std::sin(40 * p.x) * std::sin(40 * p.y + 1) * std::sin(40 * p.z + 2);
  };
  const Sampled sampled(builder.get(), mesh, 0.2, ripples);
  const SpectrumField filtered = VertexFilter(builder.get(), mesh).apply(sampled.mean, sampled.deviation);
  EXPECT_LT(sampled.error(filtered), 1.2 * sampled.error(sampled.mean));
}

TEST(VertexFilter, DoesNotReachThroughAWall) {
  PatchScene builder = divided_room();
  const DisplayMesh mesh = mesh_of(builder.get());
  Sampled sampled(builder.get(), mesh, 0.2, [](const Vec3d& p) { return p.x > 0.03 ? 1.0 : 0.0; });
  for (Spectrum& d : sampled.deviation) d *= Spectrum(1e3);  // as if all were noise, so that all is filtered
  const auto is_dark = [&](std::size_t i) { return sampled.exact[i].sum() == 0; };
  for (std::size_t i = 0; i < sampled.mean.size(); ++i)
    if (is_dark(i)) sampled.mean[i] = Spectrum();
  const SpectrumField filtered = VertexFilter(builder.get(), mesh).apply(sampled.mean, sampled.deviation);
  const std::vector<Patch> points = vertex_patches(builder.get(), mesh);
  int changed = 0;
  for (std::size_t i = 0; i < filtered.size(); ++i)
    if (is_dark(i))
      EXPECT_EQ(filtered[i].sum(), 0) << points[i].center;
    else
      changed += filtered[i].sum() != sampled.mean[i].sum();
  EXPECT_GT(changed, mesh.gathered / 4);
}

}  // namespace
}  // namespace patchlight::test

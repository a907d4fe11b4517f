#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/optics/surface/coat_albedo.h"
#include "solver/linear/form_factor_rows.h"
#include "solver/solve.h"
#include "tests/patch_scene.h"

namespace patchlight {
namespace {

using test::PatchScene;

constexpr Color kNormal(0.04f);

/// Gives a material a coat of index 1.5, and sets what it lets through.
void coat(PatchSet& scene, std::int32_t material, float roughness, const Color& tint = Color(1.0f)) {
  scene.materials[material].roughness = roughness;
  scene.materials[material].coat = {kNormal * tint, 1.0f, tint == Color(1.0f) ? 1.5f : 0.0f};
  const CoatAlbedos albedos(scene);
  for (Patch& patch : scene.patches)
    if (scene.primitives[patch.primitive].material == material)
      patch.transmittance = Color(1.0f) - albedos.mean(specular_properties_at(scene, patch.primitive, 0.5, 0.5));
}

EnergyField solve_quietly(const PatchSet& scene, const std::string& method = "matrix",
                          const std::string& form_factors = "rays", int rays = 256) {
  SolveConfig config;
  config.method = method;
  config.form_factors = form_factors;
  config.hemicube_resolution = 32;
  config.rays = rays;
  Transport transport;
  Progress progress({"test", true, ""});
  return solve(scene, config, transport, progress);
}

double mean_irradiance(const PatchSet& scene, const EnergyField& energy, int channel = 1) {
  double sum = 0, area = 0;
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    if (scene.patches[i].emission != Color(0.0f)) continue;
    for (const auto& group : energy.groups)
      sum += scene.patches[i].area * double(group.direct[i][channel] + group.indirect[i][channel]);
    area += scene.patches[i].area;
  }
  return sum / area;
}

TEST(CoatsSolved, SurfacesThatAbsorbNothingUnderASkyAreAsBrightAsIt) {
  for (const float roughness : {0.0f, 0.4f, 1.0f}) {
    PatchScene builder;
    builder.quad({{{-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}}}, 8, 8, {0.99999f});
    builder.quad({{{-2, 0, -2}, {2, 0, -2}, {2, 3, -2}, {-2, 3, -2}}}, 8, 8, {0.99999f});
    builder.quad({{{-2, 0, -2}, {-2, 3, -2}, {-2, 3, 2}, {-2, 0, 2}}}, 8, 8, {0.99999f});
    PatchSet& scene = builder.get();
    Environment sky;
    sky.texels.assign(1, Color(1.0f));
    sky.rows = 24;
    sky.cells.assign(2 * 24 * 24, Color(1.0f));
    scene.environment = sky;
    coat(scene, 0, roughness);
    const EnergyField energy = solve_quietly(scene);
    EXPECT_NEAR(mean_irradiance(scene, energy), kPi, 0.004 * kPi) << roughness;
    const std::vector<Color> b = radiosity(scene, energy);
    EXPECT_NEAR(b[9].y, scene.patches[9].transmittance.y * kPi, 0.02 * kPi) << "B = E + rho tau H";
    for (const Color& h : energy.groups[0].display) ASSERT_NEAR(h.y, kPi, 0.12 * kPi);
  }
}

/// Row sums of a closed room, one wall of which is a lamp without a coat, without the patches of metals.
SpectrumField row_sums_without_metals(PatchSet& scene) {
  scene.primitives[0].material = scene.primitives[0].light_group = 0;
  scene.patches[0].emission = Color(1.0f);
  Transport transport;
  Progress progress({"test", true, ""});
  solve(scene, {}, transport, progress);
  SpectrumField counted, sums(scene.patches.size());
  for (const Patch& patch : scene.patches)
    counted.emplace_back(Color(1.0f) - scene.materials[scene.primitives[patch.primitive].material].specular);
  FormFactorRows(transport, 0).gather(counted, sums);
  return sums;
}

TEST(CoatsSolved, RowsOfAClosedRoomAddUpToOne) {
  for (const float clear : {0.0f, 0.9f})
    for (const float metal : {0.0f, 1.0f}) {  // of a mirror under a clear coat
      PatchScene builder;
      PatchSet& scene = builder.get();
      scene.materials = {{"lamp"}, {"coated"}, {"car"}};
      builder.room(1, 4, {0.99999f, 0.0f, 0, 1});
      scene.materials[1].clear_coat = scene.materials[2].clear_coat = {clear, 0.2f};
      scene.materials[2].specular = Color(metal);
      scene.materials[2].roughness = 0.0f;
      if (metal > 0) scene.primitives[5].material = 2;
      coat(scene, 1, 0.8f);
      for (const Spectrum& sum : row_sums_without_metals(scene)) EXPECT_NEAR(sum.c[1], 1.0, 1e-5) << clear << metal;
    }
}

TEST(CoatsSolved, ARoomAbsorbsWhatItsLampEmits) {
  for (const float reflectance : {0.3f, 0.8f})
    for (const float roughness : {0.1f, 0.7f}) {
      PatchScene builder;
      builder.get().materials.push_back({"coated"});
      builder.room(1, 8, {reflectance, 0.0f, 0, 1});
      builder.quad({{{-1, 0.99, -1}, {1, 0.99, -1}, {1, 0.99, 1}, {-1, 0.99, 1}}}, 1, 1, {0.0f, 10.0f});
      PatchSet& scene = builder.get();
      coat(scene, 1, roughness);
      const EnergyField energy = solve_quietly(scene, "matrix", "rays", 512);
      double emitted = 0, absorbed = 0;
      for (std::size_t i = 0; i < scene.patches.size(); ++i) {
        const Patch& patch = scene.patches[i];
        const double irradiance = double(energy.groups[0].direct[i].y + energy.groups[0].indirect[i].y);
        emitted += patch.area * double(patch.emission.y);
        absorbed += patch.area * irradiance * double((1 - patch.reflectance.y) * patch.transmittance.y);
      }
      EXPECT_LT(energy.estimate->balance, 0.02);
      // tau is a mean over directions: of light that comes from above, it lets up to 5% less pass than a coat does.
      EXPECT_LT(absorbed / emitted, 1.005) << reflectance << ' ' << roughness;
      EXPECT_GT(absorbed / emitted, 0.95) << reflectance << ' ' << roughness;
    }
}

TEST(CoatsSolved, BrightenARoom) {
  PatchScene builder;
  builder.get().materials.push_back({"coated"});
  builder.room(1, 6, {0.8f, 0.0f, 0, 1});
  builder.quad({{{-0.3, 0.9, -0.3}, {0.3, 0.9, -0.3}, {0.3, 0.9, 0.3}, {-0.3, 0.9, 0.3}}}, 1, 1, {0.0f, 10.0f});
  PatchSet& scene = builder.get();
  const double bare = mean_irradiance(scene, solve_quietly(scene));
  coat(scene, 1, 0.5f);
  const double coated = mean_irradiance(scene, solve_quietly(scene));
  EXPECT_GT(coated, 1.03 * bare) << "light under the coat that is not absorbed leaves the room more slowly";
  const double absorbing = mean_irradiance(scene, solve_quietly(scene, "progressive"));
  EXPECT_LT(absorbing, coated) << "other methods let coats absorb what they reflect";
  EXPECT_NEAR(mean_irradiance(scene, solve_quietly(scene, "matrix", "hemicube")), absorbing, 0.05 * absorbing);
}

TEST(CoatsSolved, TintsColourWhatTheyReflect) {
  PatchScene builder;  // black walls under coats that reflect red alone
  builder.get().materials.push_back({"coated"});
  builder.room(1, 6, {0.0f, 0.0f, 0, 1});
  builder.quad({{{-0.9, 0.9, -0.9}, {0.9, 0.9, -0.9}, {0.9, 0.9, 0.9}, {-0.9, 0.9, 0.9}}}, 1, 1, {0.0f, 10.0f});
  PatchSet& scene = builder.get();
  const double bare = mean_irradiance(scene, solve_quietly(scene), 2);
  coat(scene, 1, 0.3f, Color(9.0f, 0.0f, 0.0f));
  for (Patch& patch : scene.patches) EXPECT_GE(patch.transmittance.x, 0.0f);
  const EnergyField energy = solve_quietly(scene);
  EXPECT_GT(mean_irradiance(scene, energy, 0), 1.2 * bare);
  EXPECT_LT(mean_irradiance(scene, energy, 2), 1.1 * bare) << "only at grazing angles";
}

TEST(CoatsSolved, ThatReflectAllLightAreFinite) {
  PatchScene builder;  // as of index 0, which stands for a reflectance of 1
  builder.get().materials.push_back({"coated"});
  builder.room(1, 4, {0.5f, 0.0f, 0, 1});
  builder.quad({{{-0.9, 0.9, -0.9}, {0.9, 0.9, -0.9}, {0.9, 0.9, 0.9}, {-0.9, 0.9, 0.9}}}, 1, 1, {0.0f, 10.0f});
  PatchSet& scene = builder.get();
  coat(scene, 1, 0.0f, Color(25.0f, 25.0f, 1.0f));
  ASSERT_LT(scene.patches[0].transmittance.x, 1e-5f);
  const EnergyField energy = solve_quietly(scene);
  for (int channel : {0, 2}) {
    EXPECT_TRUE(std::isfinite(mean_irradiance(scene, energy, channel)));
    EXPECT_GT(mean_irradiance(scene, energy, channel), 0);
  }
}

}  // namespace
}  // namespace patchlight

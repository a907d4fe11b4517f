#include "tests/end_to_end/accuracy/places/place.h"
#include "tests/patch_scene.h"

namespace patchlight::test {
namespace {

/// An ellipsoid of 40 x 20 smooth facets.
Mesh egg(const Vec3f& middle, const Vec3f& radii) {
  Mesh mesh = uv_sphere(40, 20);
  for (Vec3f& p : mesh.positions) {
    mesh.normals.push_back((p / radii).normalized());
    p = middle + p * radii;
  }
  return mesh;
}

/// A bumpy ground of 4 m and 40 x 40 flat facets around the origin, below y = 0.
Mesh ground() {
  Mesh mesh = grid(40);
  for (Vec3f& p : mesh.positions) {
    const float x = p.x / 10 - 2, z = 2 - p.y / 10;
    p = Vec3f(x, 0.1f * (std::sin(3 * x) * std::cos(2.5f * z) - 1), z);
  }
  return mesh;
}

/// Each triangle as four of the same shape.
Mesh split_in_four(const Mesh& mesh) {
  Mesh result;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const auto at = [&](const std::vector<Vec3f>& values, int k) {
      return values[mesh.indices[t + std::size_t(k % 3)]];
    };
    const auto first = std::uint32_t(result.positions.size());
    for (int k = 0; k < 3; ++k) result.positions.push_back(at(mesh.positions, k));
    for (int k = 0; k < 3; ++k) result.positions.push_back((at(mesh.positions, k) + at(mesh.positions, k + 1)) * 0.5f);
    for (int k = 0; k < 3 && !mesh.normals.empty(); ++k) result.normals.push_back(at(mesh.normals, k));
    for (int k = 0; k < 3 && !mesh.normals.empty(); ++k)
      result.normals.push_back((at(mesh.normals, k) + at(mesh.normals, k + 1)).normalized());
    for (const std::uint32_t k : {0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5}) result.indices.push_back(first + k);
  }
  return result;
}

/// A body close above bumpy ground, beside a wall, under a sky.
void set_up(Place& place, bool finely = false) {
  const auto shape = [&](const Mesh& mesh) { return finely ? split_in_four(mesh) : mesh; };
  place.sky = Color(1.0f);
  place.accuracy = 0.05;
  place.mesh("ground", shape(ground()));
  place.mesh("egg", shape(egg({0.2f, 0.65f, 0.1f}, {0.4f, 0.6f, 0.3f})));
  place.box("wall", {-1.2f, -0.3f, -1.5f}, {-1, 1.5f, 1.5f});
}

std::size_t clusters_of(const PatchSet& scene) {
  return std::size_t(
      std::count_if(scene.patches.begin(), scene.patches.end(), [](const Patch& patch) { return patch.facets > 0; }));
}

TEST(Clusters, HaveTheLightOfFinePatches) {
  Place coarse, fine;
  set_up(coarse);
  set_up(fine);
  coarse.solve();
  fine.accuracy = 0.3;
  fine.solve({{"ground", 4e-3}, {"egg", 1e-3}, {"wall", 5e-3}}, 512);
  ASSERT_GT(clusters_of(coarse.scene), 100u);
  ASSERT_EQ(clusters_of(fine.scene), 0u);
  for (const char* node : {"ground", "egg"}) {
    Difference difference;
    for (std::size_t i = 0; i < coarse.scene.primitives.size(); i += 7) {
      const Primitive& p = coarse.scene.primitives[i];
      const SurfacePoint middle = point_at(p, 0.5, 0.5);
      if (coarse.scene.nodes[p.node] != node) continue;
      const double reference = fine.at(node, middle.position, Vec3d(middle.normal));
      const double value = coarse.at(node, middle.position, Vec3d(middle.normal));
      if (reference > 0.05) difference.add(value, reference);
    }
    EXPECT_GT(difference.count, 50);
    EXPECT_LT(difference.mean(), 0.01) << node;
    EXPECT_LT(difference.rms(), 0.04) << node;
  }
}

TEST(Clusters, OfFinelyDividedMeshesAreAsMany) {
  Place coarse, fine;
  set_up(coarse);
  set_up(fine, true);
  coarse.solve();
  fine.solve();
  const auto unknowns = [](const Place& place) { return double(place.scene.patches.size()); };
  const auto vertices = [](const Place& place) { return double(place.energy().display->gathered); };
  EXPECT_GT(fine.scene.primitives.size(), coarse.scene.primitives.size() + 2000) << "flat facets merge again";
  EXPECT_NEAR(unknowns(fine) / unknowns(coarse), 1, 0.15);
  EXPECT_NEAR(vertices(fine) / vertices(coarse), 1, 0.15);
}

TEST(Clusters, GetTheLightOfEvenlyBrightWalls) {
  PatchScene builder;
  builder.room(1, 4, {0.0f, 2.0f});
  std::vector<std::array<Vec3d, 4>> body;  // a convex one, of 12 x 6 facets
  const auto at = [](int around, int up) {
    const double angle = 2 * kPi * (around % 12) / 12, height = kPi * up / 6;
    return Vec3d(0.3 * std::sin(height) * std::cos(angle), -0.6 * std::cos(height),
                 -0.2 * std::sin(height) * std::sin(angle));
  };
  for (int up = 0; up < 6; ++up)
    for (int k = 0; k < 12; ++k)
      if (up < 5) body.push_back({at(k, up), up == 0 ? at(k + 1, 1) : at(k + 1, up), at(k + 1, up + 1), at(k, up + 1)});
  for (int k = 0; k < 12; ++k) body.push_back({at(k, 5), at(k + 1, 5), at(k, 6), at(k, 6)});
  body.erase(body.begin(), body.begin() + 12);
  for (int k = 0; k < 12; ++k) body.push_back({at(k, 0), at(k + 1, 1), at(k, 1), at(k, 1)});
  builder.cluster(body, {0.7f});
  const PatchSet& scene = builder.get();
  for (const char* method : {"matrix", "progressive"})
    for (const char* form_factors : {"rays", "hemicube"}) {
      SolveConfig config;
      config.method = method;
      config.form_factors = form_factors;
      Progress progress({"test", true, ""});
      Transport transport;
      const EnergyField energy = solve(scene, config, transport, progress);
      EXPECT_NEAR(energy.groups[0].direct.back().x + energy.groups[0].indirect.back().x, 2, 0.06)
          << method << ", " << form_factors;
    }
}

}  // namespace
}  // namespace patchlight::test

#include "tests/end_to_end/accuracy/places/place.h"

namespace patchlight::test {
namespace {

Mesh translated(Mesh mesh, const Vec3f& shift) {
  for (Vec3f& p : mesh.positions) p += shift;
  return mesh;
}

/// Turns +Z to -Y: what faces +Z then faces down.
Mesh facing_down(Mesh mesh) {
  for (Vec3f& p : mesh.positions) p = Vec3f(p.x, -p.z, p.y);
  return mesh;
}

/// The square from -1 to 1 at y = 0, facing down, with a hole of 24 corners.
Mesh holed_ceiling() {
  return facing_down(plate_with_hole(3, 0.3));
}

/// A cube from -1 to 1 without its top (+1) or bottom (-1), lit inside.
Mesh open_box(int open) {
  Mesh mesh = inverted(cube()), result{mesh.positions, {}, {}};
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const auto is_open = [&](std::size_t k) { return mesh.positions[mesh.indices[t + k]].y == float(open); };
    if (!(is_open(0) && is_open(1) && is_open(2)))
      result.indices.insert(result.indices.end(), mesh.indices.begin() + std::ptrdiff_t(t),
                            mesh.indices.begin() + std::ptrdiff_t(t) + 3);
  }
  return result;
}

/// A closed room whose double-sided ceiling has a hole into a closed box on top of it.
PatchSet furnace() {
  GltfBuilder gltf;
  const Json grey = {{"doubleSided", true},
                     {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}, {"metallicFactor", 0}}},
                     {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}};
  const int material = gltf.material(grey);
  gltf.node({{"name", "ceiling"}, {"mesh", gltf.mesh(holed_ceiling(), material)}, {"translation", {0, 1, 0}}});
  gltf.node({{"name", "room"}, {"mesh", gltf.mesh(open_box(1), material)}});
  gltf.node({{"name", "box"},
             {"mesh", gltf.mesh(translated(scaled(open_box(-1), Vec3f(0.45f, 0.2f, 0.45f)), {0, 1.2f, 0}), material)}});
  PatchSet scene = Importer().import(gltf);
  scene.light_groups = {"all"};
  for (Primitive& p : scene.primitives) p.light_group = 0;
  for (Patch& patch : scene.patches) patch.emission = Color(1.0f);
  return scene;
}

bool is_inside(const Patch& patch) {
  const Vec3d p = patch.center + Vec3d(patch.normal) * 1e-4;
  const bool in_room = std::abs(p.x) < 1 && std::abs(p.y) < 1 && std::abs(p.z) < 1;
  return in_room || (std::abs(p.x) < 0.45 && std::abs(p.z) < 0.45 && p.y > 1 && p.y < 1.4);
}

TEST(PlanarRegions, InAFurnaceKeepAllLight) {
  const PatchSet scene = furnace();
  ASSERT_TRUE(std::any_of(scene.primitives.begin(), scene.primitives.end(), [](const auto& p) { return p.region; }));
  for (const char* form_factors : {"rays", "hemicube"}) {
    SolveConfig config;
    config.form_factors = form_factors;
    config.tolerance = 1e-6;
    Progress progress({"test", true, ""});
    Transport transport;
    const std::vector<Color> b = radiosity(scene, solve(scene, config, transport, progress));
    struct Mean {
      double light = 0, area = 0;
    };
    std::map<std::pair<std::int32_t, bool>, Mean> means;  // of nodes, and of their sides up and down
    for (std::size_t i = 0; i < scene.patches.size(); ++i) {
      const Patch& patch = scene.patches[i];
      if (!is_inside(patch)) continue;
      EXPECT_NEAR(b[i].x, 2, 0.1) << form_factors << ", " << patch.center;
      Mean& mean = means[{scene.primitives[patch.primitive].node, patch.normal.y > 0}];
      mean.light += double(b[i].x) * patch.area;
      mean.area += patch.area;
    }
    EXPECT_EQ(means.size(), 5u) << "the box has no side that faces up";
    for (const auto& [part, mean] : means) EXPECT_NEAR(mean.light / mean.area, 2, 4e-3) << form_factors;
  }
}

/// A room of which one wall is missing, under the sky, whose ceiling has holes with boxes above them.
void build_ceiling(Place& place) {
  place.sky = Color(1.0f);
  place.box("floor", {-3, -0.2f, -2}, {3, 0, 2});
  place.box("west", {-3.2f, -0.2f, -2}, {-3, 2.6f, 2});
  place.box("north", {-3, -0.2f, -2.2f}, {3, 2.6f, -2});
  place.box("south", {-3, -0.2f, 2}, {3, 2.6f, 2.2f});
  place.box("roof", {-3.2f, 2.5f, -2.2f}, {3.2f, 2.6f, 2.2f});
  Mesh all;
  for (int x = 0; x < 3; ++x)
    for (int z = 0; z < 2; ++z) {
      const Mesh part = translated(holed_ceiling(), {float(2 * x - 2), 2.4f, float(2 * z - 1)});
      const auto first = std::uint32_t(all.positions.size());
      all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
      for (const std::uint32_t k : part.indices) all.indices.push_back(first + k);
    }
  place.mesh("ceiling", all);
}

TEST(PlanarRegions, CeilingWithHolesIsSmoothAndRight) {
  Place usual, fine;
  build_ceiling(usual);
  build_ceiling(fine);
  usual.solve();
  fine.solve({{"ceiling", 1e-3}}, 1024);
  EXPECT_EQ(std::count_if(usual.scene.primitives.begin(), usual.scene.primitives.end(),
                          [](const auto& p) { return p.region != nullptr; }),
            1);
  Difference difference;
  for (double x = -2.95; x < 3; x += 0.1)
    for (double z = -1.95; z < 2; z += 0.1) {
      const double from_x = x - 2 * std::round(x / 2), from_z = z - 2 * std::floor(z / 2) - 1;
      if (std::hypot(from_x, from_z) < 0.31) continue;
      const Vec3d point(x, 2.4, z), normal(0, -1, 0);
      difference.add(usual.at("ceiling", point, normal), fine.at("ceiling", point, normal));
    }
  EXPECT_LT(difference.mean(), 0.005);
  EXPECT_LT(difference.rms(), 0.015);
  EXPECT_LT(difference.largest, 0.12);
}

/// A box on a ground of 60 m: a square, or a disc of 32 corners.
void build_ground(Place& place, bool round) {
  place.sky = Color(1.0f);
  if (round) {
    Mesh disc;
    for (int k = 0; k < 32; ++k)
      disc.positions.emplace_back(Vec3d(30 * std::cos(kPi * k / 16), 0, -30 * std::sin(kPi * k / 16)));
    for (std::uint32_t k = 2; k < 32; ++k) disc.indices.insert(disc.indices.end(), {0, k - 1, k});
    place.mesh("ground", disc);
  } else {
    place.level("ground", 0, 0, 0, 30);
  }
  place.box("box", {-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f});
}

TEST(PlanarRegions, ARoundGroundIsAsASquareOne) {
  Place square, disc;
  build_ground(square, false);
  build_ground(disc, true);
  square.solve({{"box", 0.01}}, 1024);
  disc.solve();
  Difference difference;
  for (double distance = 0.52; distance < 10; distance *= 1.1)
    for (double along = -0.9; along < 1; along += 0.2)
      difference.add(disc.at("ground", {distance, 0, along * distance}, {0, 1, 0}),
                     square.at("ground", {distance, 0, along * distance}, {0, 1, 0}));
  EXPECT_LT(difference.mean(), 0.005);
  EXPECT_LT(difference.rms(), 0.015);
}

}  // namespace
}  // namespace patchlight::test

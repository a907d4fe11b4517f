#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "solver/solve.h"
#include "tests/importers/gltf_builder.h"
#include "tracer/light/solution/solved_surfaces.h"

namespace patchlight::test {

/// Boxes and squares of grey surfaces and lamps, as an importer reads them, with their light.
class Place {
 public:
  void box(const char* name, const Vec3f& low, const Vec3f& high) {
    const Vec3f half = (high - low) * 0.5f, middle = low + half;
    gltf_.node({{"name", name},
                {"mesh", gltf_.mesh(scaled(cube(), half), material())},
                {"translation", {middle.x, middle.y, middle.z}}});
  }
  /// A level square that faces up, or a lamp that faces down.
  void level(const char* name, float x, float y, float z, float half, bool is_lamp = false) {
    const Vec3f a(x - half, y, z - half), b(x - half, y, z + half), c(x + half, y, z + half), d(x + half, y, z - half);
    gltf_.node({{"name", name},
                {"mesh", gltf_.mesh(is_lamp ? quad_mesh({d, c, b, a}) : quad_mesh({a, b, c, d}),
                                    is_lamp ? lamp_material() : material())}});
  }

  void mesh(const char* name, const Mesh& shape) {
    gltf_.node({{"name", name}, {"mesh", gltf_.mesh(shape, material())}});
  }

  /// `finer`: nodes whose patches have an area, m2.
  void solve(const std::map<std::string, double>& finer = {}, int rays = 256) {
    Importer importer;
    importer.job.environment.color = sky;
    importer.job.import.accuracy = accuracy;
    for (const auto& [name, area] : finer) {
      importer.job.nodes.emplace_back().pattern = name;
      importer.job.nodes.back().patch_area = area;
    }
    scene = importer.import(gltf_);
    SolveConfig config;
    config.rays = rays;
    Progress progress({"test", true, ""});
    Transport transport;
    energy_ = patchlight::solve(scene, config, transport, progress);
    surfaces_.emplace(scene, energy_, mixes_, trace_, SmoothEdges(scene.primitives));
  }

  /// Irradiance at a point of a node's surface that faces `normal`, W/m2, without the lamps' own light.
  double at(const std::string& node, const Vec3d& point, const Vec3d& normal) const {
    for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) {
      const Primitive& p = scene.primitives[i];
      if (scene.nodes[p.node] != node || (facing(p) ^ normal) < 0.99) continue;
      const Imath::V2d uv = uv_of(p, point);
      if ((position_at(p.corners, uv.x, uv.y) - point).length() > 1e-6) continue;
      SurfaceHit hit;
      hit.primitive = i;
      hit.front = true;
      hit.u = float(uv.x);
      hit.v = float(uv.y);
      return surfaces_->irradiance(hit, surfaces_->blend(hit, surfaces_->colors(hit).patch)).x;
    }
    ADD_FAILURE() << node << " has no surface at " << point;
    return 0;
  }

  const EnergyField& energy() const { return energy_; }

  std::optional<Color> sky{};  ///< Radiance, W/m2/sr.
  double accuracy = 1;
  PatchSet scene;

 private:
  int material() {
    return gltf_.material({{"name", "paint"},
                           {"pbrMetallicRoughness", {{"baseColorFactor", {0.6, 0.6, 0.6, 1}}, {"metallicFactor", 0}}}});
  }
  int lamp_material() { return gltf_.material({{"name", "lamp"}, {"emissiveFactor", {1, 1, 1}}}); }

  GltfBuilder gltf_;
  EnergyField energy_;
  const TraceConfig trace_;
  const LightMixes mixes_{{Color(1.0f)}, false};
  std::optional<SolvedSurfaces> surfaces_;
};

/// Relative differences of a place's light from another's.
struct Difference {
  double squares = 0, bias = 0, largest = 0;
  int count = 0;

  void add(double value, double reference) {
    const double difference = value / reference - 1;
    squares += difference * difference;
    bias += difference;
    largest = std::max(largest, std::abs(difference));
    ++count;
  }
  double rms() const { return std::sqrt(squares / count); }
  double mean() const { return std::abs(bias / count); }
};

}  // namespace patchlight::test

#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight::test {

/// Builds small PatchSets for tests of the stages after the import.
class PatchScene {
 public:
  PatchScene() {
    scene_.nodes = {"node"};
    scene_.materials = {{"default", Color(0.0f), 1.0f}};
    scene_.light_groups = {"light"};
    scene_.cameras.emplace_back().name = "camera";
    scene_.key = "0123456789abcdef";
  }

  struct Surface {
    float reflectance = 0.5f;
    float emission = 0.0f;
    int group = 0;
    int material = 0;
  };

  /// A quad of nu x nv patches; corners run counter-clockwise as seen from the lit side. Returns the primitive's index.
  int quad(const std::array<Vec3d, 4>& corners, int nu, int nv, const Surface& surface) {
    Primitive p;
    p.corners = corners;
    const int index = add(p, surface);
    for (int j = 0; j < nv; ++j)
      for (int i = 0; i < nu; ++i)
        cell(index, float(i) / float(nu), float(j) / float(nv), i + 1, nu, j + 1, nv, surface);
    return index;
  }

  /// A sphere of rings of equal polar angle with `around` patches each; a negative radius is lit inside.
  int sphere(const Vec3d& center, double radius, int rings, int around, const Surface& surface) {
    Primitive p;
    p.shape = Primitive::Shape::sphere;
    p.sphere_center = center;
    p.sphere_radius = radius;
    const int index = add(p, surface);
    for (int j = 0; j < rings; ++j)
      for (int i = 0; i < around; ++i)
        cell(index, float(i) / float(around), float(j) / float(rings), i + 1, around, j + 1, rings, surface);
    return index;
  }

  /// A cluster of quads. Corners at the same place are smooth. Returns the index of its first facet.
  int cluster(const std::vector<std::array<Vec3d, 4>>& facets, const Surface& surface) {
    Patch patch;
    patch.primitive = std::int32_t(scene_.primitives.size());
    patch.facets = std::int32_t(facets.size());
    patch.u0 = patch.v0 = patch.u1 = patch.v1 = 0;
    patch.reflectance = Color(surface.reflectance);
    Vec3d normals(0.0);
    for (const auto& corners : facets) {
      Primitive p;
      p.corners = corners;
      for (int k = 0; k < 4; ++k) p.smooth_vertices[k] = smooth_vertex(corners[k]);
      add(p, surface);
      const Vec3d area = 0.5 * ((corners[2] - corners[0]) % (corners[3] - corners[1]));
      patch.area += area.length();
      normals += area;
      patch.center = point_at(p, 0.5, 0.5).position;
      patch.normal = point_at(p, 0.5, 0.5).normal;
    }
    if (normals.length() > 1e-6 * patch.area) patch.normal = Vec3f(normals.normalized());
    scene_.patches.push_back(patch);
    return patch.primitive;
  }

  /// The six walls of a cube from -half to half, lit inside; walls in the order -x, +x, -y, +y, -z, +z.
  void room(double half, int cells, const Surface& surface) {
    const double h = half;
    quad({{{-h, -h, -h}, {-h, h, -h}, {-h, h, h}, {-h, -h, h}}}, cells, cells, surface);
    quad({{{h, -h, -h}, {h, -h, h}, {h, h, h}, {h, h, -h}}}, cells, cells, surface);
    quad({{{-h, -h, -h}, {-h, -h, h}, {h, -h, h}, {h, -h, -h}}}, cells, cells, surface);
    quad({{{-h, h, -h}, {h, h, -h}, {h, h, h}, {-h, h, h}}}, cells, cells, surface);
    quad({{{-h, -h, -h}, {h, -h, -h}, {h, h, -h}, {-h, h, -h}}}, cells, cells, surface);
    quad({{{-h, -h, h}, {-h, h, h}, {h, h, h}, {h, -h, h}}}, cells, cells, surface);
  }

  PatchSet& get() { return scene_; }

 private:
  /// The number of the smooth vertex at a place, among those of clusters.
  std::int32_t smooth_vertex(const Vec3d& at) {
    const auto found = std::find(places_.begin(), places_.end(), at);
    if (found == places_.end()) places_.push_back(at);
    return std::int32_t(std::find(places_.begin(), places_.end(), at) - places_.begin());
  }

  int add(Primitive& p, const Surface& surface) {
    p.material = surface.material;
    p.light_group = surface.emission > 0 ? surface.group : -1;
    scene_.primitives.push_back(p);
    return int(scene_.primitives.size()) - 1;
  }

  void cell(int index, float u0, float v0, int i, int nu, int j, int nv, const Surface& surface) {
    const Primitive& p = scene_.primitives[index];
    Patch patch;
    patch.primitive = index;
    patch.u0 = u0;
    patch.v0 = v0;
    patch.u1 = float(i) / float(nu);
    patch.v1 = float(j) / float(nv);
    const SurfacePoint middle = point_at(p, 0.5 * (patch.u0 + patch.u1), 0.5 * (patch.v0 + patch.v1));
    patch.center = middle.position;
    patch.normal = middle.normal;
    if (p.shape == Primitive::Shape::sphere) {
      patch.area = p.sphere_radius * p.sphere_radius * 2 * kPi * double(patch.u1 - patch.u0) *
                   (std::cos(kPi * patch.v0) - std::cos(kPi * patch.v1));
    } else {
      const Vec3d a = point_at(p, patch.u0, patch.v0).position, b = point_at(p, patch.u1, patch.v0).position;
      const Vec3d c = point_at(p, patch.u1, patch.v1).position, d = point_at(p, patch.u0, patch.v1).position;
      patch.area = 0.5 * ((c - a) % (d - b)).length();
    }
    patch.reflectance = Color(surface.reflectance);
    patch.emission = Color(surface.emission);
    scene_.patches.push_back(patch);
  }

  PatchSet scene_;
  std::vector<Vec3d> places_;  ///< Of smooth vertices.
};

/// A light that emits downwards, twice as much red as green.
inline Light light_at(const Vec3d& position, Light::Kind kind = Light::Kind::point) {
  Light light;
  light.kind = kind;
  light.strength = Color(10.0f, 5.0f, 0.0f);
  light.position = position;
  light.direction = {0, -1, 0};
  return light;
}

}  // namespace patchlight::test

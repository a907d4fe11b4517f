#include "tracer/light/display_lookup.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

DisplayLookup::DisplayLookup(const PatchSet& scene, const IrradianceLookup& patches, const EnergyField& energy,
                             const std::vector<LightMix>& mixes)
    : patches_(patches), mesh_(*energy.display), faces_(scene, mesh_) {
  for (std::size_t m = 0; m < mixes.size(); ++m) {
    std::vector<Color>& irradiance = irradiance_.emplace_back(mesh_.vertices.size(), Color(0.0f));
    for (std::size_t g = 0; g < energy.groups.size(); ++g)
      for (std::int32_t k = 0; k < mesh_.gathered; ++k) irradiance[k] += energy.groups[g].display[k] * mixes[m][g];
    const std::size_t first_midpoint = mesh_.vertices.size() - mesh_.midpoints.size();
    for (std::size_t k = mesh_.gathered; k < first_midpoint; ++k) {
      const DisplayMesh::Vertex& vertex = mesh_.vertices[k];
      irradiance[k] = patches_(scene.patches[vertex.patch].primitive, vertex.u, vertex.v, m);
    }
    for (std::size_t k = 0; k < mesh_.midpoints.size(); ++k)
      irradiance[first_midpoint + k] = (irradiance[mesh_.midpoints[k][0]] + irradiance[mesh_.midpoints[k][1]]) * 0.5f;
  }
  if (!mesh_.facets.empty()) facet_of_.assign(scene.patches.size(), -1);
  for (const auto& facet : mesh_.facets) {
    const std::int32_t primitive = scene.patches[facet.patch].primitive;
    facet_of_[facet.patch] = std::int32_t(facets_.size());
    auto& corners = facets_.emplace_back(facet.corners);
    for (int k = 0; k < 4; ++k) {
      if (corners[k] >= 0) continue;
      corners[k] = std::int32_t(irradiance_[0].size());
      for (std::size_t m = 0; m < mixes.size(); ++m)
        irradiance_[m].push_back(patches_(primitive, float(k % 2), float(k / 2), m));
    }
  }
}

DisplayLookup::Blend DisplayLookup::blend(std::int32_t patch, float u, float v) const {
  Blend blend;
  const auto set_bilinear = [&](std::span<const std::int32_t> corners, float x, float y) {
    blend.count = 4;
    for (int k = 0; k < 4; ++k) {
      blend.vertices[k] = corners[k];
      blend.weights[k] = (k % 2 ? x : 1.0f - x) * (k / 2 ? y : 1.0f - y);
    }
  };
  const FaceLookup::Place place = faces_.find(patch, u, v);
  if (place.face < 0) {
    if (!facet_of_.empty() && facet_of_[patch] >= 0) set_bilinear(facets_[facet_of_[patch]], u, v);
    return blend;
  }
  const auto corners = mesh_.corners_of(mesh_.faces[place.face]);
  if (!place.cut) {
    set_bilinear(corners, place.u, place.v);
    return blend;
  }
  blend.count = int(corners.size());
  std::copy(corners.begin(), corners.end(), blend.vertices.begin());
  set_mean_value_weights(u, v, blend);
  return blend;
}

void DisplayLookup::set_mean_value_weights(float u, float v, Blend& blend) const {
  const int n = blend.count;
  std::array<Vec2d, DisplayMesh::kMostCorners> to;
  std::array<double, DisplayMesh::kMostCorners> length, half_tangent, weights{};
  for (int k = 0; k < n; ++k) {
    const DisplayMesh::Vertex& vertex = mesh_.vertices[blend.vertices[k]];
    to[k] = Vec2d(double(vertex.u) - u, double(vertex.v) - v);
    length[k] = to[k].length();
  }
  double sum = 0;
  const auto on_edge = [&](int k, int next) {
    const double both = length[k] + length[next];
    weights.fill(0);
    weights[k] = both > 0 ? length[next] / both : 1;
    weights[next] += both > 0 ? length[k] / both : 0;
    sum = 1;
  };
  bool inside = true;
  for (int k = 0; k < n && inside; ++k) {
    const int next = (k + 1) % n;
    const double cross = to[k].cross(to[next]), dot = to[k].dot(to[next]);
    inside = std::abs(cross) > 1e-9 * length[k] * length[next] || dot > 0;
    if (!inside) on_edge(k, next);
    half_tangent[k] = (length[k] * length[next] - dot) / cross;
  }
  for (int k = 0; k < n && inside; ++k) {
    const double tangents = half_tangent[(k + n - 1) % n] + half_tangent[k];
    weights[k] = tangents > 0 && std::isfinite(tangents) ? tangents / length[k] : 0;  // outside by a rounding: none
    sum += weights[k];
  }
  if (sum <= 0) on_edge(int(std::min_element(length.begin(), length.begin() + n) - length.begin()), 0);
  for (int k = 0; k < n; ++k) blend.weights[k] = float(weights[k] / sum);
}

Color DisplayLookup::operator()(const Blend& blend, std::int32_t i, float u, float v, std::size_t mix) const {
  if (blend.count == 0) return patches_(i, u, v, mix);
  Color sum(0.0f);
  for (int k = 0; k < blend.count; ++k) sum += irradiance_[mix][blend.vertices[k]] * blend.weights[k];
  return sum;
}

}  // namespace patchlight

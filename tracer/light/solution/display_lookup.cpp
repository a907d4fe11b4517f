#include "tracer/light/solution/display_lookup.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

DisplayLookup::DisplayLookup(const PatchSet& scene, const IrradianceLookup& patches, const EnergyField& energy,
                             const std::vector<LightMix>& mixes)
    : scene_(scene), patches_(patches), mesh_(*energy.display), faces_(scene, mesh_) {
  if (!mesh_.cuts.empty()) place_corners(scene);
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
  for (const auto& blend : mesh_.blends)
    for (std::vector<Color>& irradiance : irradiance_) {
      Color sum(0.0f);
      for (const auto& part : mesh_.parts_of(blend)) sum += irradiance[part.vertex] * part.weight;
      irradiance.push_back(sum);
    }
  if (!mesh_.facets.empty()) facet_of_.assign(scene.primitives.size(), -1);
  for (const auto& facet : mesh_.facets) {
    const std::int32_t primitive = scene.patches[facet.patch].primitive + facet.facet;
    facet_of_[primitive] = std::int32_t(facets_.size());
    auto& corners = facets_.emplace_back(facet.corners);
    for (int k = 0; k < 4; ++k) {
      if (corners[k] >= 0) continue;
      corners[k] = std::int32_t(irradiance_[0].size());
      for (std::size_t m = 0; m < mixes.size(); ++m)
        irradiance_[m].push_back(patches_(primitive, float(k % 2), float(k / 2), m));
    }
  }
}

void DisplayLookup::place_corners(const PatchSet& scene) {
  first_place_.assign(mesh_.faces.size(), -1);
  corner_places_.reserve(mesh_.corners.size());
  for_each_cut_leaf(scene, mesh_, [&](const DisplayMesh::Cell& leaf, const Patch& cell) {
    const Primitive& primitive = scene.primitives[cell.primitive];
    const PlaneFrame frame = *PlaneFrame::of(primitive);
    for_each_part(mesh_.cuts, leaf.cut, cell_polygon(primitive, frame, cell),
                  [&](const Polygon& polygon, std::int32_t face) {
                    if (std::int32_t(polygon.size()) != mesh_.faces[face].count) return;  // lost in rounding
                    first_place_[face] = std::int32_t(corner_places_.size());
                    for (const Vec2d& corner : polygon)
                      corner_places_.emplace_back(uv_of(primitive, frame.to_world(corner)));
                  });
  });
}

DisplayLookup::Blend DisplayLookup::blend(std::int32_t i, std::int32_t patch, float u, float v) const {
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
    if (!facet_of_.empty() && facet_of_[i] >= 0) set_bilinear(facets_[facet_of_[i]], u, v);
    return blend;
  }
  const auto corners = mesh_.corners_of(mesh_.faces[place.face]);
  if (!place.cut) {
    set_bilinear(corners, place.u, place.v);
    if (mesh_.faces[place.face].middles > 0) add_middles(patch, place, blend);
    return blend;
  }
  blend.count = int(corners.size());
  std::copy(corners.begin(), corners.end(), blend.vertices.begin());
  set_mean_value_weights(place.face, u, v, blend);
  return blend;
}

/// Adds the vertices in the middle of a leaf's edges, each with the share of a linear function that is 1 there and 0 at
/// the corners and along the other edges.
void DisplayLookup::add_middles(std::int32_t patch, const FaceLookup::Place& place, Blend& blend) const {
  const Patch& cell = scene_.patches[patch];
  for (const std::int32_t middle : mesh_.middles_of(mesh_.faces[place.face])) {
    const DisplayMesh::Vertex& vertex = mesh_.vertices[middle];
    const float u = (vertex.u - cell.u0) / (cell.u1 - cell.u0) - 0.5f;
    const float v = (vertex.v - cell.v0) / (cell.v1 - cell.v0) - 0.5f;
    const bool at_v = std::abs(v) > std::abs(u);
    const float along = at_v ? place.u : place.v, across = at_v ? place.v : place.u;
    const bool far = (at_v ? v : u) > 0;
    const float share = (1.0f - std::abs(2.0f * along - 1.0f)) * (far ? across : 1.0f - across);
    const int first = far ? (at_v ? 2 : 1) : 0, second = first + (at_v ? 1 : 2);
    blend.weights[first] -= 0.5f * share;
    blend.weights[second] -= 0.5f * share;
    blend.vertices[blend.count] = middle;
    blend.weights[blend.count++] = share;
  }
}

void DisplayLookup::set_mean_value_weights(std::int32_t face, float u, float v, Blend& blend) const {
  const int n = blend.count;
  const std::int32_t first = first_place_[face];
  std::array<Vec2d, DisplayMesh::kMostCorners> to;
  std::array<double, DisplayMesh::kMostCorners> length, half_tangent, weights{};
  for (int k = 0; k < n; ++k) {
    const DisplayMesh::Vertex& vertex = mesh_.vertices[blend.vertices[k]];
    const Vec2f at = first < 0 ? Vec2f(vertex.u, vertex.v) : corner_places_[first + k];
    to[k] = Vec2d(double(at.x) - u, double(at.y) - v);
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

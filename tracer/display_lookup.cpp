#include "tracer/display_lookup.h"

#include <algorithm>

#include "pipeline/optics/elements.h"

namespace patchlight {

DisplayLookup::DisplayLookup(const PatchSet& scene, const RayScene& ray_scene, const IrradianceLookup& patches,
                             const EnergyField& energy, const std::vector<Color>& settings)
    : scene_(scene), ray_scene_(ray_scene), patches_(patches), mesh_(*energy.display) {
  irradiance_.assign(mesh_.vertices.size(), Color(0.0f));
  for (std::size_t g = 0; g < energy.groups.size(); ++g)
    for (std::int32_t k = 0; k < mesh_.gathered; ++k) irradiance_[k] += energy.groups[g].display[k] * settings[g];
  const std::size_t first_midpoint = mesh_.vertices.size() - mesh_.midpoints.size();
  for (std::size_t k = mesh_.gathered; k < first_midpoint; ++k) {
    const DisplayMesh::Vertex& vertex = mesh_.vertices[k];
    irradiance_[k] = patches_(scene.patches[vertex.patch].primitive, vertex.u, vertex.v);
  }
  for (std::size_t k = 0; k < mesh_.midpoints.size(); ++k)
    irradiance_[first_midpoint + k] = (irradiance_[mesh_.midpoints[k][0]] + irradiance_[mesh_.midpoints[k][1]]) * 0.5f;
  if (!mesh_.facets.empty()) facet_of_.assign(scene.patches.size(), -1);
  for (const auto& facet : mesh_.facets) {
    const std::int32_t primitive = scene.patches[facet.patch].primitive;
    facet_of_[facet.patch] = std::int32_t(facets_.size());
    auto& corners = facets_.emplace_back();
    for (int k = 0; k < 4; ++k)
      corners[k] =
          facet.corners[k] >= 0 ? irradiance_[facet.corners[k]] : patches_(primitive, float(k % 2), float(k / 2));
  }
}

void DisplayLookup::Seen::start(std::uint32_t pixel) {
  if (pixel == pixel_) return;
  pixel_ = pixel;
  entries_.fill({});
}

Color DisplayLookup::operator()(std::int32_t i, std::int32_t patch, float u, float v, Seen& seen) const {
  if (mesh_.roots[patch] < 0) {
    if (facet_of_.empty() || facet_of_[patch] < 0) return patches_(i, u, v);
    const auto& at = facets_[facet_of_[patch]];
    return (at[0] * (1 - u) + at[1] * u) * (1 - v) + (at[2] * (1 - u) + at[3] * u) * v;
  }
  return within(mesh_.find(patch, scene_.patches[patch], u, v), i, u, v, seen);
}

Color DisplayLookup::within(const DisplayMesh::Place& place, std::int32_t i, float u, float v, Seen& seen) const {
  std::array<float, 4> weights;
  for (int k = 0; k < 4; ++k) weights[k] = (k % 2 ? place.u : 1.0f - place.u) * (k / 2 ? place.v : 1.0f - place.v);
  const auto& corners = place.leaf->corners;
  const auto mean = [&] {
    Color sum(0.0f);
    for (int k = 0; k < 4; ++k) sum += irradiance_[corners[k]] * weights[k];
    return sum;
  };
  if (!place.leaf->cut) return mean();

  const std::uint32_t corners_left = corners_seen(*place.leaf, i, u, v, seen);
  float left = 0;
  for (int k = 0; k < 4; ++k) left += corners_left >> k & 1u ? weights[k] : 0.0f;
  if (left <= 0) return mean();
  for (int k = 0; k < 4; ++k) weights[k] = corners_left >> k & 1u ? weights[k] / left : 0.0f;
  return mean();
}

std::uint32_t DisplayLookup::corners_seen(const DisplayMesh::Cell& leaf, std::int32_t i, float u, float v,
                                          Seen& seen) const {
  for (Seen::Entry& entry : seen.entries_)
    if (entry.leaf == &leaf && entry.uses < Seen::kUses) {
      ++entry.uses;
      return entry.corners;
    }
  const auto same = std::find_if(seen.entries_.begin(), seen.entries_.end(),
                                 [&](const Seen::Entry& entry) { return entry.leaf == &leaf; });
  Seen::Entry& entry = same != seen.entries_.end() ? *same : seen.entries_[seen.next_++ % Seen::kLeaves];
  entry = {&leaf, seen_corners(scene_, ray_scene_, mesh_, leaf, i, std::array{Vec2f(u, v)}), 1};
  return entry.corners;
}

}  // namespace patchlight

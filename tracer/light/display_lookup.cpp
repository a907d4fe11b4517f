#include "tracer/light/display_lookup.h"

#include <algorithm>

#include "pipeline/optics/transport/elements.h"

namespace patchlight {

DisplayLookup::DisplayLookup(const PatchSet& scene, const RayScene& ray_scene, const IrradianceLookup& patches,
                             const EnergyField& energy, const std::vector<LightMix>& mixes)
    : scene_(scene), ray_scene_(ray_scene), patches_(patches), mesh_(*energy.display) {
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

void DisplayLookup::CornerCache::start(std::uint32_t pixel) {
  if (pixel == pixel_) return;
  pixel_ = pixel;
  entries_.fill({});
}

DisplayLookup::Blend DisplayLookup::blend(std::int32_t i, std::int32_t patch, float u, float v,
                                          CornerCache& cache) const {
  Blend blend;
  auto& weights = blend.weights;
  const auto set_weights = [&](float x, float y) {
    for (int k = 0; k < 4; ++k) weights[k] = (k % 2 ? x : 1.0f - x) * (k / 2 ? y : 1.0f - y);
  };
  if (mesh_.roots[patch] < 0) {
    if (facet_of_.empty() || facet_of_[patch] < 0) return blend;
    blend.vertices = facets_[facet_of_[patch]];
    set_weights(u, v);
    return blend;
  }
  const DisplayMesh::Place place = mesh_.find(patch, scene_.patches[patch], u, v);
  set_weights(place.u, place.v);
  blend.vertices = place.leaf->corners;
  if (!place.leaf->cut) return blend;

  const std::uint32_t visible = cached_visible_corners(*place.leaf, i, u, v, cache);
  float total = 0;
  for (int k = 0; k < 4; ++k) total += visible >> k & 1u ? weights[k] : 0.0f;
  if (total <= 0) return blend;
  for (int k = 0; k < 4; ++k) weights[k] = visible >> k & 1u ? weights[k] / total : 0.0f;
  return blend;
}

Color DisplayLookup::operator()(const Blend& blend, std::int32_t i, float u, float v, std::size_t mix) const {
  if (blend.vertices[0] < 0) return patches_(i, u, v, mix);
  Color sum(0.0f);
  for (int k = 0; k < 4; ++k) sum += irradiance_[mix][blend.vertices[k]] * blend.weights[k];
  return sum;
}

std::uint32_t DisplayLookup::cached_visible_corners(const DisplayMesh::Cell& leaf, std::int32_t i, float u, float v,
                                                    CornerCache& cache) const {
  for (CornerCache::Entry& entry : cache.entries_)
    if (entry.leaf == &leaf && entry.uses < CornerCache::kMaxUses) {
      ++entry.uses;
      return entry.corners;
    }
  const auto found = std::find_if(cache.entries_.begin(), cache.entries_.end(),
                                  [&](const CornerCache::Entry& entry) { return entry.leaf == &leaf; });
  CornerCache::Entry& entry =
      found != cache.entries_.end() ? *found : cache.entries_[cache.next_++ % CornerCache::kLeaves];
  entry = {&leaf, visible_corners(scene_, ray_scene_, mesh_, leaf, i, std::array{Vec2f(u, v)}), 1};
  return entry.corners;
}

}  // namespace patchlight

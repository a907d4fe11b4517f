#include "solver/display/display_mesh_builder.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <span>

#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/transport/elements.h"
#include "solver/direct/direct_factors.h"
#include "solver/display/display_facets.h"
#include "solver/display/display_vertices.h"
#include "solver/form_factors/harmonic_distance.h"

namespace patchlight {

namespace {

// Measured: smaller values cost more vertices than they are worth.
// Thresholds of the size of a patch or cell over the harmonic mean distance.
constexpr float kNear = 0.25f;    // for vertices of its own
constexpr float kSplit = 0.25f;   // for refinement
constexpr float kContact = 4.0f;  // for refinement to the last level, at contacts and small gaps

/// Measures for the refinement of a patch or cell.
struct CellMeasure {
  float criterion = 0.0f;  ///< Size over harmonic mean distance.
  bool cut = false;        ///< A surface stands between the corners.
};

class Builder {
 public:
  Builder(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup, std::uint64_t seed)
      : scene_(scene), ray_scene_(ray_scene), lookup_(lookup), smooth_(scene), seed_(seed) {}

  DisplayMesh build(std::int64_t& cast) {
    mesh_.roots.assign(scene_.patches.size(), -1);
    add_roots(cast);
    std::vector<std::int32_t> level;
    for (std::size_t i = 0; i < mesh_.cells.size(); ++i) level.push_back(std::int32_t(i));
    for (int depth = 0; !level.empty(); ++depth) level = refine(level, depth, cast);
    add_display_vertices(scene_, ray_scene_, lookup_, smooth_, mesh_);
    for (auto& cell : mesh_.cells) {
      if (cell.children < 0) cell.leaf = mesh_.elements;
      mesh_.elements += cell.elements();
    }
    add_display_facets(scene_, ray_scene_, lookup_, near_facets_, mesh_);
    cast += std::int64_t(mesh_.vertices.size()) * RayPacket::kSize;
    return std::move(mesh_);
  }

 private:
  /// Adds roots for patches near other surfaces and for their neighbours, so that irradiance varies little where
  /// divided patches border on undivided ones.
  void add_roots(std::int64_t& cast) {
    const std::vector<CellMeasure> measures = measure(scene_.patches, cast);
    const DirectFactors::FindNeighbours neighbours = grid_neighbours(scene_, lookup_);
    for (std::int32_t i = 0; i < std::int32_t(measures.size()); ++i) {
      if (measures[i].criterion < kNear && !measures[i].cut) continue;
      if (is_facet(scene_.patches[i].primitive)) {
        near_facets_.push_back(i);
        continue;
      }
      mesh_.roots[i] = 0;
      DirectFactors::NeighbourList near;
      for (const std::int32_t j : std::span(near).first(neighbours(i, near))) mesh_.roots[j] = 0;
    }
    for (std::size_t i = 0; i < mesh_.roots.size(); ++i) {
      if (mesh_.roots[i] < 0) continue;
      mesh_.roots[i] = std::int32_t(mesh_.cells.size());
      mesh_.cells.emplace_back();
      cell_patches_.push_back(scene_.patches[i]);
    }
  }

  /// Divides the cells of a level that need it. Returns the new cells.
  std::vector<std::int32_t> refine(const std::vector<std::int32_t>& level, int depth, std::int64_t& cast) {
    const auto needs_refinement = [&](const CellMeasure& cell) {
      if (depth + 1 < kDisplayLevels) return cell.criterion >= kSplit || cell.cut;
      return depth < kDisplayLevels && cell.criterion >= kContact;
    };
    std::vector<Patch> parts;
    for (const std::int32_t i : level) parts.push_back(cell_patches_[i]);
    const std::vector<CellMeasure> measures = measure(parts, cast);
    std::vector<std::int32_t> next;
    for (std::size_t k = 0; k < level.size(); ++k) {
      DisplayMesh::Cell& cell = mesh_.cells[level[k]];
      if (!needs_refinement(measures[k])) continue;
      cell.children = std::int32_t(mesh_.cells.size());
      for (const Patch& quarter : quarters(scene_, parts[k])) {
        next.push_back(std::int32_t(mesh_.cells.size()));
        mesh_.cells.emplace_back();
        cell_patches_.push_back(quarter);
      }
    }
    return next;
  }

  bool is_facet(std::int32_t i) const {
    return (lookup_.rows(i) == 1 || lookup_.row(i, 0).cells == 1) && smooth_.is_smooth(scene_.primitives[i]);
  }

  std::vector<CellMeasure> measure(const std::vector<Patch>& parts, std::int64_t& cast) const {
    constexpr int kBlock = 256;
    std::vector<CellMeasure> measures(parts.size());
    const int count = int(parts.size());
    tbb::parallel_for(0, (count + kBlock - 1) / kBlock, [&](int block) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
      for (int k = block * kBlock; k < std::min((block + 1) * kBlock, count); ++k)
        measures[k] = {
            refinement_criterion(scene_, ray_scene_, parts[k], hash64(seed_ ^ hash64(std::uint64_t(k)))).value,
            is_cut(scene_, ray_scene_, parts[k])};
    });
    cast += std::int64_t(count) * (RayPacket::kSize + 6);
    Progress::check_interrupted();
    return measures;
  }

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const PatchLookup& lookup_;
  const SmoothEdges smooth_;
  const std::uint64_t seed_;
  DisplayMesh mesh_;
  std::vector<Patch> cell_patches_;        ///< [cells].
  std::vector<std::int32_t> near_facets_;  ///< Patches.
};

}  // namespace

DisplayMesh build_display_mesh(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup,
                               std::uint64_t seed, std::int64_t& cast) {
  return Builder(scene, ray_scene, lookup, hash64(seed)).build(cast);
}

}  // namespace patchlight

#include "solver/display/display_mesh_builder.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <unordered_map>

#include "pipeline/optics/cuts/cell_cutter.h"
#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/transport/face_lookup.h"
#include "solver/direct/direct_factors.h"
#include "solver/display/facets/display_facets.h"
#include "solver/display/fine_detail.h"
#include "solver/display/leaf_faces.h"
#include "solver/display/leaf_lattice.h"
#include "solver/display/region_vertices.h"
#include "solver/form_factors/harmonic_distance.h"

namespace patchlight {

namespace {

// Measured: smaller values cost more vertices than they are worth.
// Thresholds of the size of a patch or cell over the harmonic mean distance.
constexpr float kNear = 0.25f;       // for vertices of its own
constexpr float kSplit = 0.25f;      // for refinement
constexpr float kContact = 4.0f;     // for refinement to the last of kLevels, at contacts and small gaps
constexpr int kLevels = 3;           // of refinement by distances
constexpr double kLeast = 1.0 / 64;  // of the target of their scale: area of cells that distances do not refine

class Builder {
 public:
  Builder(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup, std::uint64_t seed)
      : scene_(scene),
        ray_scene_(ray_scene),
        lookup_(lookup),
        lattices_(scene, lookup),
        smooth_(scene.primitives),
        of_cluster_(facets_of_clusters(scene)),
        reach_(reach()),
        crossings_(find_crossings(scene.primitives, [this](std::int32_t i) { return reach_[i]; })),
        at_edges_(find_crossings_at_edges(scene.primitives, [this](std::int32_t i) { return reach_[i]; })),
        seams_(scene, lattices_, reach_, at_edges_),
        detail_(scene, crossings_, at_edges_),
        lines_(with_outlines(crossings_)),
        seed_(seed) {}

  DisplayMesh build(std::int64_t& cast) {
    mesh_.roots.assign(scene_.patches.size(), -1);
    add_roots(cast);
    std::vector<std::int32_t> level;
    for (std::size_t i = 0; i < mesh_.cells.size(); ++i) level.push_back(std::int32_t(i));
    for (int depth = 0; !level.empty(); ++depth) level = refine(std::move(level), depth, cast);
    add_faces(scene_, lookup_, lattices_, seams_, smooth_, lines_, is_open_, mesh_);
    move_into_regions(scene_, lookup_, mesh_.vertices);
    add_display_facets(scene_, ray_scene_, lookup_, near_facets_, mesh_, cast);
    return std::move(mesh_);
  }

 private:
  /// Adds roots for patches near other surfaces and for their neighbours, so that irradiance varies little where
  /// divided patches border on undivided ones.
  void add_roots(std::int64_t& cast) {
    const std::vector<RefinementCriterion> measures = measure(scene_.patches, cast);
    for (const RefinementCriterion& measure : measures) is_open_.push_back(measure.is_open);
    const DirectFactors::FindNeighbours neighbours = grid_neighbours(scene_, lookup_, lattices_, true);
    for (std::int32_t i = 0; i < std::int32_t(measures.size()); ++i) {
      const Patch& patch = scene_.patches[i];
      const bool is_near = !patch.triangles.empty() || measures[i].value >= kNear || detail_.is_too_large(patch);
      const bool facet = is_facet(patch.primitive);
      if (!facet && seams_.touches(patch)) mesh_.roots[i] = 0;
      if (!is_near) continue;
      if (patch.cut < 0 && facet) {
        near_facets_.push_back(i);
        continue;
      }
      mesh_.roots[i] = 0;
      DirectFactors::NeighbourList near;
      for (const std::int32_t j : std::span(near).first(neighbours(i, near))) mesh_.roots[j] = 0;
    }
    std::unordered_map<std::int32_t, std::int32_t> root_of_cut;
    for (std::size_t i = 0; i < mesh_.roots.size(); ++i) {
      const Patch& patch = scene_.patches[i];
      if (mesh_.roots[i] < 0) continue;
      if (patch.cut >= 0) {
        const auto [at, is_new] = root_of_cut.try_emplace(patch.cut, std::int32_t(mesh_.cells.size()));
        mesh_.roots[i] = at->second;
        if (!is_new) continue;
      }
      mesh_.roots[i] = std::int32_t(mesh_.cells.size());
      mesh_.cells.emplace_back();
      cell_patches_.push_back(patch.cut < 0 ? patch : sub_patch(scene_, patch, patch.u0, patch.v0, patch.u1, patch.v1));
    }
  }

  /// Divides the cells of a level that need it. Returns the new cells.
  std::vector<std::int32_t> refine(std::vector<std::int32_t> level, int depth, std::int64_t& cast) {
    const auto is_too_large = [&](std::int32_t i) {
      return depth < kMostLevels && detail_.is_too_large(cell_patches_[i]);
    };
    std::erase_if(level, [&](std::int32_t i) { return cell_patches_[i].area <= 0; });  // outside of a region
    if (depth >= kLevels) std::erase_if(level, [&](std::int32_t i) { return !is_too_large(i); });
    const auto needs_refinement = [&](const RefinementCriterion& criterion, std::int32_t i) {
      if (!criterion.is_open) return false;
      if (depth >= kLevels) return true;
      if (is_too_large(i)) return true;
      const Patch& cell = cell_patches_[i];
      return cell.area > kLeast * scene_.primitives[cell.primitive].patch_area &&
             criterion.value >= (depth + 1 < kLevels ? kSplit : kContact);
    };
    std::vector<Patch> parts;
    for (const std::int32_t i : level) parts.push_back(cell_patches_[i]);
    const std::vector<RefinementCriterion> measures = measure(parts, cast);
    std::vector<std::int32_t> next;
    for (std::size_t k = 0; k < level.size(); ++k) {
      DisplayMesh::Cell& cell = mesh_.cells[level[k]];
      if (!needs_refinement(measures[k], level[k])) continue;
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
    return of_cluster_[i] ||
           ((lookup_.rows(i) == 1 || lookup_.row(i, 0).cells == 1) && smooth_.is_smooth(scene_.primitives[i]));
  }

  /// The largest height at which an edge of another surface counts as standing on a primitive, m; negative: the
  /// primitive is not cut. Shape: [primitives].
  std::vector<double> reach() const {
    std::vector<double> reach(scene_.primitives.size(), -1.0);
    for (const Patch& patch : scene_.patches)
      reach[patch.primitive] = std::max(reach[patch.primitive], CellCutter::kHighest * std::sqrt(patch.area));
    for (std::int32_t i = 0; i < std::int32_t(reach.size()); ++i)
      if (is_facet(i)) reach[i] = -1.0;
    return reach;
  }

  /// Crossings, and the outlines of regions.
  std::vector<std::vector<Crossing>> with_outlines(std::vector<std::vector<Crossing>> lines) const {
    const auto outlines = outlines_of_regions(scene_.primitives);
    for (std::size_t i = 0; i < lines.size(); ++i)
      lines[i].insert(lines[i].end(), outlines[i].begin(), outlines[i].end());
    return lines;
  }

  /// Criteria of patches or cells.
  std::vector<RefinementCriterion> measure(const std::vector<Patch>& parts, std::int64_t& cast) const {
    constexpr int kBlock = 256;
    std::vector<RefinementCriterion> measures(parts.size());
    const int count = int(parts.size());
    tbb::parallel_for(0, (count + kBlock - 1) / kBlock, [&](int block) {
      _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
      for (int k = block * kBlock; k < std::min((block + 1) * kBlock, count); ++k)
        measures[k] = refinement_criterion(scene_, ray_scene_, parts[k], hash64(seed_ ^ hash64(std::uint64_t(k))));
    });
    for (const RefinementCriterion& measure : measures) cast += measure.rays;
    Progress::check_interrupted();
    return measures;
  }

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const PatchLookup& lookup_;
  const Lattices lattices_;
  const SmoothEdges smooth_;
  const std::vector<bool> of_cluster_;  ///< [primitives]
  const std::vector<double> reach_;
  const std::vector<std::vector<Crossing>> crossings_;  ///< [primitives]
  const std::vector<std::vector<Crossing>> at_edges_;   ///< [primitives]
  const Seams seams_;
  const FineDetail detail_;
  const std::vector<std::vector<Crossing>> lines_;  ///< [primitives] Along which leaves are cut.
  const std::uint64_t seed_;
  DisplayMesh mesh_;
  std::vector<bool> is_open_;              ///< [patches] See RefinementCriterion.
  std::vector<Patch> cell_patches_;        ///< [cells].
  std::vector<std::int32_t> near_facets_;  ///< Patches.
};

}  // namespace

DisplayMesh build_display_mesh(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup,
                               std::uint64_t seed, std::int64_t& cast) {
  return Builder(scene, ray_scene, lookup, hash64(seed)).build(cast);
}

}  // namespace patchlight

#include "importers/patches/patch_builder.h"

#include <fmt/format.h>

#include <limits>
#include <span>

#include "pipeline/model/error.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {
namespace {

constexpr double kClosed = 1e-3;  // length of the sum of area vectors over the area, below which it has no direction
constexpr float kFacing = 1e-3f;  // cosine to the cluster's normal of facets at its centre

/// The patch of a cluster. Its centre is the middle of a facet: of the facets on the lit side of the cluster's normal,
/// the one nearest to the cluster's centroid.
Patch cluster_patch(const std::vector<Primitive>& primitives, const SurfaceMaterial& material,
                    const FacetCluster& cluster) {
  Patch patch;
  patch.reflectance = material.reflectance;
  patch.emission = material.emission;
  patch.primitive = cluster.first;
  patch.facets = cluster.count;
  patch.u0 = patch.v0 = patch.u1 = patch.v1 = 0;
  Vec3d mean(0.0), normals(0.0);
  const auto facets = std::span(primitives).subspan(std::size_t(cluster.first), std::size_t(cluster.count));
  for (const Primitive& facet : facets) {
    const double area = primitive_area(facet);
    const SurfacePoint middle = point_at(facet, 0.5, 0.5);
    patch.area += area;
    mean += middle.position * area;
    normals += Vec3d(middle.normal) * area;
  }
  mean /= patch.area;
  const bool is_closed = normals.length() < kClosed * patch.area;
  patch.normal = is_closed ? point_at(facets[0], 0.5, 0.5).normal : Vec3f(normals.normalized());
  double nearest = std::numeric_limits<double>::infinity();
  for (const Primitive& facet : facets) {
    const SurfacePoint middle = point_at(facet, 0.5, 0.5);
    const double distance = (middle.position - mean).length2();
    if (!(middle.normal.dot(patch.normal) > kFacing) || distance >= nearest) continue;
    nearest = distance;
    patch.center = middle.position;
  }
  return patch;
}

}  // namespace

std::vector<Patch> build_patches(const std::vector<Primitive>& primitives,
                                 const std::vector<SurfaceMaterial>& materials, const std::vector<PatchTarget>& targets,
                                 const std::vector<FacetCluster>& clusters) {
  std::vector<Patch> patches;
  double cells = 0.0;  // of regions
  std::size_t next = 0;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    if (next < clusters.size() && std::int32_t(i) == clusters[next].first) {
      patches.push_back(cluster_patch(primitives, materials[primitives[i].material], clusters[next]));
      i += std::size_t(clusters[next++].count) - 1;
      continue;
    }
    if (primitives[i].region) {
      const QuadGrid grid = targets[i].grid.columns > 0 ? targets[i].grid : quad_grid(primitives[i], targets[i].area);
      cells += double(grid.columns) * grid.rows;
    }
    if (cells > double(Region::kMostCells))
      throw Error(ExitCode::over_limit,
                  fmt::format("grids on planar regions have more than {} cells", Region::kMostCells),
                  "import.patch_area", "raise it, or lower import.accuracy");
    append_patches(primitives[i], static_cast<std::int32_t>(i), materials[primitives[i].material], targets[i], patches);
  }
  return patches;
}

}  // namespace patchlight

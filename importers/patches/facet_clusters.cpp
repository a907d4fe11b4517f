#include "importers/patches/facet_clusters.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "importers/mesh/vertex_welding.h"
#include "importers/patches/facet_bodies.h"

namespace patchlight {
namespace {

constexpr std::int32_t kFewestFacets = 24;  // of a body: boxes stay quads
constexpr double kLargestFacet = 0.5;       // area over the target, and
constexpr double kLongestFacet = 0.7;       // length over its root
constexpr double kLargestCluster = 1.4;     // area of a cluster over its target
constexpr double kLongestCluster = 0.6;     // standard deviation of positions over the root of the target
constexpr double kMostTurn = 0.15;          // 1 minus the length of the mean normal: 45 degrees around it
constexpr double kSmallCluster = 0.25;      // area over the target up to which normals count in proportion to the area

using Moments = Eigen::Matrix3d;

/// Integrals over facets: of positions, of unit normals, and of the products of their components.
struct Integrals {
  double area = 0, target = 0;
  Vec3d position{0.0}, normal{0.0};
  Moments positions = Moments::Zero(), normals = Moments::Zero();

  void add(const Integrals& other) {
    area += other.area;
    target += other.target;
    position += other.position;
    normal += other.normal;
    positions += other.positions;
    normals += other.normals;
  }
};

Eigen::Vector3d eigen(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

void add_triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, Integrals& sum) {
  const Vec3d cross = (b - a) % (c - a);
  const double area = 0.5 * cross.length();
  if (!(area > 0)) return;
  const Vec3d middle = (a + b + c) / 3.0;
  const Eigen::Vector3d normal = eigen(cross.normalized());
  sum.area += area;
  sum.position += middle * area;
  sum.normal += cross * 0.5;
  sum.normals += area * normal * normal.transpose();
  sum.positions += 0.75 * area * eigen(middle) * eigen(middle).transpose();
  for (const Vec3d& corner : {a, b, c}) sum.positions += area / 12.0 * eigen(corner) * eigen(corner).transpose();
}

/// Of a facet, relative to `origin`.
Integrals integrals_of(const Primitive& p, double target, const Vec3d& origin) {
  Integrals sum;
  const auto at = [&](int k) { return p.corners[k] - origin; };
  add_triangle(at(0), at(1), at(2), sum);
  add_triangle(at(0), at(2), at(3), sum);
  sum.target = target * sum.area;
  return sum;
}

/// The direction in which values vary most, and their variance along it.
std::pair<Eigen::Vector3d, double> main_direction(const Moments& products, const Vec3d& sum, double area) {
  const Eigen::Vector3d mean = eigen(sum) / area;
  const Eigen::SelfAdjointEigenSolver<Moments> solver(products / area - mean * mean.transpose());
  return {solver.eigenvectors().col(2), std::max(0.0, solver.eigenvalues()[2])};
}

/// Divides the facets of one kind of a body into parts.
class Division {
 public:
  Division(const std::vector<Primitive>& primitives, const std::vector<PatchTarget>& targets,
           std::vector<std::int32_t>& part_of)
      : primitives_(primitives), targets_(targets), part_of_(part_of) {}

  /// Sets `part_of` [primitives] of the facets; brings neighbours together in their order.
  void divide(std::span<std::int32_t> facets, std::int32_t& parts) {
    const Vec3d origin = primitives_[facets[0]].corners[0];
    Integrals all;
    for (const std::int32_t i : facets) all.add(integrals_of(primitives_[i], targets_[i].area, origin));
    const double target = all.target / all.area;
    const auto [along, variance] = main_direction(all.positions, all.position, all.area);
    const double size = std::max(all.area / (kLargestCluster * target), std::sqrt(variance / target) / kLongestCluster);
    const double turn =
        (1 - all.normal.length() / all.area) / kMostTurn * std::min(1.0, all.area / (kSmallCluster * target));
    if (facets.size() == 1 || std::max(size, turn) <= 1) {
      for (const std::int32_t i : facets) part_of_[i] = parts;
      ++parts;
      return;
    }
    const bool by_normal = turn > size;
    const Eigen::Vector3d axis = by_normal ? main_direction(all.normals, all.normal, all.area).first : along;
    const double middle = axis.dot(eigen(by_normal ? all.normal : all.position)) / all.area;
    const auto value = [&](std::int32_t i) {
      const Integrals own = integrals_of(primitives_[i], 0, origin);
      return axis.dot(eigen(by_normal ? own.normal : own.position)) / own.area;
    };
    auto cut = std::stable_partition(facets.begin(), facets.end(), [&](std::int32_t i) { return value(i) < middle; });
    if (cut == facets.begin() || cut == facets.end()) {  // all at one place
      cut = facets.begin() + std::ptrdiff_t(facets.size() / 2);
    }
    const auto first = std::size_t(cut - facets.begin());
    divide(facets.first(first), parts);
    divide(facets.subspan(first), parts);
  }

 private:
  const std::vector<Primitive>& primitives_;
  const std::vector<PatchTarget>& targets_;
  std::vector<std::int32_t>& part_of_;
};

/// Whether a facet may be of a cluster.
bool may_be_clustered(const Primitive& p, const SurfaceMaterial& material, const PatchTarget& target) {
  if (p.shape != Primitive::Shape::quad || p.region || p.light_group >= 0 || p.mask >= 0) return false;
  if (material.specular != Color(0.0f) || material.metal != Color(0.0f)) return false;
  const double length = std::max((p.corners[2] - p.corners[0]).length(), (p.corners[3] - p.corners[1]).length());
  if (length > kLongestFacet * std::sqrt(target.area)) return false;
  const QuadGrid grid = target.grid.columns > 0 ? target.grid : quad_grid(p, target.area);
  return grid.columns == 1 && grid.rows == 1 && primitive_area(p) <= kLargestFacet * target.area;
}

/// Facets with the same value are of one node, with the same material and pictures.
auto kind_of(const Primitive& p) {
  return std::tuple(p.node, p.material, p.shader, p.texture, p.metallic_roughness_texture, p.normal_texture,
                    p.back < 0);
}

/// Parts of bodies that are connected: facets of a part with a common neighbour are together. -1: not in a cluster.
std::vector<std::int32_t> connected_parts(const std::vector<Primitive>& primitives, const FacetBodies& bodies,
                                          const std::vector<std::int32_t>& part_of) {
  DisjointSets sets(primitives.size());
  std::vector<std::int32_t> near;
  for (std::int32_t i = 0; i < std::int32_t(primitives.size()); ++i) {
    near.clear();
    for (const std::int32_t place : bodies.places(i))
      if (place >= 0)
        for (const std::int32_t other : bodies.at(place))
          if (part_of[other] >= 0 && bodies.body(other) == bodies.body(i)) near.push_back(other);
    std::sort(near.begin(), near.end(), [&](auto a, auto b) { return part_of[a] < part_of[b]; });
    for (std::size_t k = 1; k < near.size(); ++k)
      if (part_of[near[k]] == part_of[near[k - 1]]) sets.join(near[k], near[k - 1]);
  }
  std::vector<std::int32_t> part(primitives.size(), -1), sizes(primitives.size());
  for (std::size_t i = 0; i < primitives.size(); ++i)
    if (part_of[i] >= 0) ++sizes[sets.find(std::int32_t(i))];
  for (std::size_t i = 0; i < primitives.size(); ++i)
    if (const std::int32_t set = sets.find(std::int32_t(i)); part_of[i] >= 0 && sizes[set] > 1) part[i] = set;
  return part;
}

template <class Value>
void reorder(const std::vector<std::int32_t>& order, std::vector<Value>& values) {
  if (values.empty()) return;
  std::vector<Value> result;
  result.reserve(values.size());
  for (const std::int32_t i : order) result.push_back(std::move(values[i]));
  values = std::move(result);
}

}  // namespace

std::vector<FacetCluster> cluster_facets(const std::vector<SurfaceMaterial>& materials,
                                         std::vector<PatchTarget>& targets, PrimitiveList& list) {
  std::vector<Primitive>& primitives = list.primitives;
  const auto count = std::int32_t(primitives.size());
  const FacetBodies bodies(primitives);
  std::vector<std::int32_t> facets, part_of(primitives.size(), -1);  // of the fronts
  for (std::int32_t i = 0; i < count; ++i)
    if ((primitives[i].back < 0 || i < primitives[i].back) && bodies.size(bodies.body(i)) >= kFewestFacets &&
        may_be_clustered(primitives[i], materials[primitives[i].material], targets[i]))
      facets.push_back(i);
  const auto group = [&](std::int32_t i) { return std::tuple(bodies.body(i), kind_of(primitives[i])); };
  std::stable_sort(facets.begin(), facets.end(), [&](auto a, auto b) { return group(a) < group(b); });
  std::int32_t parts = 0;
  Division division(primitives, targets, part_of);
  for (std::size_t first = 0, last = 0; first < facets.size(); first = last) {
    while (last < facets.size() && group(facets[last]) == group(facets[first])) ++last;
    division.divide(std::span(facets).subspan(first, last - first), parts);
  }
  std::vector<std::int32_t> cluster_of = connected_parts(primitives, bodies, part_of);
  std::vector<std::vector<std::int32_t>> members(primitives.size());
  for (const std::int32_t i : facets)
    if (cluster_of[i] >= 0) members[cluster_of[i]].push_back(i);

  std::vector<FacetCluster> clusters;
  std::vector<std::int32_t> order, place(primitives.size(), -1);
  const auto append = [&](std::int32_t i) {
    place[i] = std::int32_t(order.size());
    order.push_back(i);
  };
  for (std::int32_t i = 0; i < count; ++i) {
    if (place[i] >= 0) continue;
    const std::int32_t back = primitives[i].back;
    const bool is_back = back >= 0 && back < i;
    const std::int32_t cluster = cluster_of[is_back ? back : i];
    if (cluster < 0) {
      append(i);
      continue;
    }
    clusters.push_back({std::int32_t(order.size()), std::int32_t(members[cluster].size())});
    for (const std::int32_t k : members[cluster]) append(is_back ? primitives[k].back : k);
  }
  if (clusters.empty()) return clusters;
  for (Primitive& p : primitives)
    if (p.back >= 0) p.back = place[p.back];
  reorder(order, primitives);
  reorder(order, targets);
  reorder(order, list.texcoords);
  reorder(order, list.emission_texcoords);
  reorder(order, list.metallic_roughness_texcoords);
  reorder(order, list.normal_texcoords);
  reorder(order, list.colors);
  reorder(order, list.normals);
  return clusters;
}

}  // namespace patchlight

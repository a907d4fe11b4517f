#include "solver/display/facets/facet_vertices.h"

#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

#include "pipeline/optics/sampling/random.h"
#include "solver/display/facets/facet_vertex_placer.h"

namespace patchlight {

namespace {

constexpr float kReachOfVertex = 0.5f;                      // of a vertex over the harmonic mean distance,
constexpr float kLeastReach = 1.0f / 8, kMostReach = 1.0f;  // and over the size of patches
constexpr float kMostTurn = 0.78f;                          // rad: normals that differ by as much have no effect
constexpr float kServed = 0.5f;  // distance, over the reach, of nodes that need no vertex of their own
constexpr float kLeastWeight = 1e-3f;

/// A vertex that serves a node.
struct Service {
  std::int32_t node, vertex;
  float weight;
};

class Chooser {
 public:
  Chooser(const PatchSet& scene, const RayScene& ray_scene, const FacetGraph& graph,
          const std::vector<std::int32_t>& patch_of)
      : graph_(graph),
        placer_(scene, ray_scene, patch_of),
        nearest_(graph.nodes.size(), 1.0f),
        distance_(graph.nodes.size(), kFar) {}

  FacetVertices choose(std::int64_t& cast) {
    _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree requires denormals to be flushed
    std::vector<std::int32_t> order(graph_.nodes.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [](std::int32_t a, std::int32_t b) { return hash64(std::uint64_t(a)) < hash64(std::uint64_t(b)); });
    result_.of_node.assign(graph_.nodes.size(), FacetVertices::kNone);
    for (const std::int32_t node : order) {
      if (nearest_[node] < kServed) continue;
      int rays = 0;
      const PlacedVertex placed = placer_.place(graph_.corners_of(node), hash64(std::uint64_t(node)), rays);
      cast += rays;
      if (placed.covered) continue;
      const float scale = graph_.nodes[node].scale;
      serve(node, std::clamp(kReachOfVertex * placed.distance, kLeastReach * scale, kMostReach * scale));
      result_.of_node[node] = std::int32_t(result_.vertices.size());
      result_.vertices.push_back(placed.vertex);
    }
    add_blends();
    return std::move(result_);
  }

 private:
  static constexpr float kFar = 1e30f;

  /// Lets the next vertex serve the nodes around its own.
  void serve(std::int32_t from, float reach) {
    const Vec3f& normal = graph_.nodes[from].normal;
    using Entry = std::pair<float, std::int32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    const auto part_of_reach = [&](std::int32_t node, float length) {
      const float turn = std::sqrt(std::max(0.0f, 2.0f - 2.0f * graph_.nodes[node].normal.dot(normal)));
      return length / reach + turn / kMostTurn;
    };
    const auto visit = [&](std::int32_t node, float length) {
      if (length >= distance_[node] || part_of_reach(node, length) >= 1.0f) return;
      if (distance_[node] == kFar) touched_.push_back(node);
      distance_[node] = length;
      queue.push({length, node});
    };
    visit(from, 0.0f);
    while (!queue.empty()) {
      const auto [length, node] = queue.top();
      queue.pop();
      if (length > distance_[node]) continue;
      for (const FacetGraph::Way& way : graph_.ways_from(node)) visit(way.to, length + way.length);
    }
    for (const std::int32_t node : touched_) {
      const float at = part_of_reach(node, distance_[node]);
      const float root = 1.0f / std::max(at, 1e-3f) - 1.0f;
      if (root * root > kLeastWeight) services_.push_back({node, std::int32_t(result_.vertices.size()), root * root});
      nearest_[node] = std::min(nearest_[node], at);
      distance_[node] = kFar;
    }
    touched_.clear();
  }

  void add_blends() {
    std::stable_sort(services_.begin(), services_.end(),
                     [](const Service& a, const Service& b) { return a.node < b.node; });
    for (std::size_t first = 0, last = 0; first < services_.size(); first = last) {
      const std::int32_t node = services_[first].node;
      float sum = 0;
      for (; last < services_.size() && services_[last].node == node; ++last) sum += services_[last].weight;
      if (result_.of_node[node] >= 0) continue;
      result_.of_node[node] = std::int32_t(result_.vertices.size() + result_.blends.size());
      result_.blends.push_back({std::int32_t(result_.blended.size()), std::int32_t(last - first)});
      for (std::size_t k = first; k < last; ++k)
        result_.blended.push_back({services_[k].vertex, services_[k].weight / sum});
    }
  }

  const FacetGraph& graph_;
  const FacetVertexPlacer placer_;
  std::vector<float> nearest_;   ///< [nodes] Least distance from a vertex that serves it, over its reach.
  std::vector<float> distance_;  ///< [nodes] From the vertex that is being added, m.
  std::vector<std::int32_t> touched_;
  std::vector<Service> services_;
  FacetVertices result_;
};

}  // namespace

FacetVertices choose_facet_vertices(const PatchSet& scene, const RayScene& ray_scene, const FacetGraph& graph,
                                    const std::vector<std::int32_t>& patch_of, std::int64_t& cast) {
  return Chooser(scene, ray_scene, graph, patch_of).choose(cast);
}

}  // namespace patchlight

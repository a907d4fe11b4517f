#include "solver/display/facets/facet_graph.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/surface/smooth_normals.h"

namespace patchlight {

namespace {

constexpr std::size_t kMostAcrossCreases = 16;  // nodes at one place that all lead to each other

/// Sorts items by their nodes; sets the first item of each node.
template <class Item>
std::vector<Item> by_node(const std::vector<std::pair<std::int32_t, Item>>& items, std::size_t nodes,
                          std::vector<std::size_t>& starts) {
  starts.assign(nodes + 1, 0);
  for (const auto& item : items) ++starts[std::size_t(item.first) + 1];
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  std::vector<Item> sorted(items.size());
  std::vector<std::size_t> next(starts.begin(), starts.end() - 1);
  for (const auto& [node, item] : items) sorted[next[node]++] = item;
  return sorted;
}

using Ways = std::vector<std::pair<std::int32_t, FacetGraph::Way>>;

/// Adds the ways along the edges and diagonals of a facet.
void add_ways(const FacetGraph& graph, const Primitive& facet, Ways& ways) {
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < a; ++b) {
      const std::int32_t from = graph.at(facet.smooth_vertices[a]), to = graph.at(facet.smooth_vertices[b]);
      if (from == to) continue;
      const auto length = float((facet.corners[a] - facet.corners[b]).length());
      ways.push_back({from, {to, length}});
      ways.push_back({to, {from, length}});
    }
}

/// Adds the ways across creases, between nodes at the same place.
void add_crease_ways(const FacetGraph& graph, Ways& ways) {
  std::vector<std::int32_t> order(graph.nodes.size());
  std::iota(order.begin(), order.end(), 0);
  const auto place = [&](std::int32_t node) {
    const Vec3d& p = graph.nodes[node].position;
    return std::tuple(p.x, p.y, p.z);
  };
  std::sort(order.begin(), order.end(),
            [&](auto a, auto b) { return std::pair(place(a), a) < std::pair(place(b), b); });
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    while (last < order.size() && place(order[last]) == place(order[first])) ++last;
    const std::size_t reach = last - first <= kMostAcrossCreases ? last - first : 1;
    for (std::size_t k = first; k < last; ++k)
      for (std::size_t other = k + 1; other < std::min(last, k + 1 + reach); ++other) {
        ways.push_back({order[k], {order[other], 0.0f}});
        ways.push_back({order[other], {order[k], 0.0f}});
      }
  }
}

}  // namespace

FacetGraph facet_graph(const PatchSet& scene, std::span<const std::int32_t> facets) {
  FacetGraph graph;
  const SmoothNormals normals(scene);
  std::vector<std::pair<std::int32_t, FacetGraph::Corner>> corners;
  for (const std::int32_t i : facets) {
    const Primitive& facet = scene.primitives[i];
    const Vec3f flat = point_at(facet, 0.5, 0.5).normal;
    for (int k = 0; k < 4; ++k) {
      const int corner = kCornersInRows[k];
      const auto id = std::size_t(facet.smooth_vertices[corner]);
      if (id >= graph.node_of.size()) graph.node_of.resize(id + 1, -1);
      if (graph.node_of[id] < 0) {
        graph.node_of[id] = std::int32_t(graph.nodes.size());
        graph.nodes.push_back({facet.corners[corner], Vec3f(0.0f), 0.0f});
      }
      const std::int32_t number = graph.node_of[id];
      FacetGraph::Node& node = graph.nodes[number];
      node.normal += normals(i, float(k % 2), float(k / 2), flat);
      node.scale = std::max(node.scale, float(std::sqrt(facet.patch_area)));
      corners.push_back({number, {i, k}});
    }
  }
  for (FacetGraph::Node& node : graph.nodes) node.normal.normalize();
  graph.corners = by_node(corners, graph.nodes.size(), graph.corner_starts);
  Ways ways;
  for (const std::int32_t i : facets) add_ways(graph, scene.primitives[i], ways);
  add_crease_ways(graph, ways);
  graph.ways = by_node(ways, graph.nodes.size(), graph.way_starts);
  return graph;
}

}  // namespace patchlight

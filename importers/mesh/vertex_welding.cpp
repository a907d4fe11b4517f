#include "importers/mesh/vertex_welding.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <random>
#include <tuple>

namespace patchlight {
namespace {

/// A half-edge: one triangle's use of an edge.
struct HalfEdge {
  std::int32_t low = 0;  ///< Vertices, low < high.
  std::int32_t high = 0;
  std::int32_t triangle = 0;
  bool upward = false;  ///< From low to high.

  auto edge() const { return std::tie(low, high); }
  auto order() const { return std::tie(high, triangle); }  ///< Among equal `low`.
};

/// Counting sort by a key in [0, keys), then by order() among equal keys.
template <class Entry, class Key>
std::vector<Entry> sorted_by(Key Entry::*key, std::size_t keys, const std::vector<Entry>& items) {
  std::vector<std::uint32_t> counts(keys + 1, 0);
  for (const Entry& item : items) ++counts[std::size_t(item.*key) + 1];
  std::partial_sum(counts.begin(), counts.end(), counts.begin());
  std::vector<Entry> sorted(items.size());
  for (const Entry& item : items) sorted[counts[std::size_t(item.*key)]++] = item;
  const auto before = [](const Entry& a, const Entry& b) { return a.order() < b.order(); };
  for (std::size_t k = 0, begin = 0; k < keys; begin = counts[k++])
    std::sort(sorted.begin() + std::ptrdiff_t(begin), sorted.begin() + std::ptrdiff_t(counts[k]), before);
  return sorted;
}

std::vector<HalfEdge> sorted_half_edges(const std::vector<std::int32_t>& weld, std::size_t vertices,
                                        const std::vector<std::int32_t>& triangles) {
  std::vector<HalfEdge> half_edges;
  half_edges.reserve(triangles.size() * 3);
  for (const std::int32_t triangle : triangles) {
    for (int i = 0; i < 3; ++i) {
      const std::int32_t from = weld[3 * triangle + i];
      const std::int32_t to = weld[3 * triangle + (i + 1) % 3];
      half_edges.push_back({std::min(from, to), std::max(from, to), triangle, from < to});
    }
  }
  return sorted_by(&HalfEdge::low, vertices, half_edges);
}

/// Sets of triangles connected through manifold edges of consistent winding.
DisjointSets manifold_surfaces(const std::vector<HalfEdge>& half_edges, std::size_t triangles) {
  DisjointSets sets(triangles);
  for (std::size_t begin = 0; begin < half_edges.size();) {
    std::size_t end = begin + 1;
    while (end < half_edges.size() && half_edges[end].edge() == half_edges[begin].edge()) ++end;
    if (end - begin == 2 && half_edges[begin].upward != half_edges[begin + 1].upward) {
      sets.join(half_edges[begin].triangle, half_edges[begin + 1].triangle);
    }
    begin = end;
  }
  return sets;
}

}  // namespace

DisjointSets::DisjointSets(std::size_t count) : parent(count) {
  std::iota(parent.begin(), parent.end(), 0);
}

std::int32_t DisjointSets::find(std::int32_t member) {
  while (parent[member] != member) member = parent[member] = parent[parent[member]];
  return member;
}

void DisjointSets::join(std::int32_t a, std::int32_t b) {
  const std::int32_t root_a = find(a);
  const std::int32_t root_b = find(b);
  parent[std::max(root_a, root_b)] = std::min(root_a, root_b);
}

std::vector<std::int32_t> weld_corners(const std::vector<Vec3d>& positions) {
  // Hash table with a random factor, so that no file can be made to cause collisions on purpose.
  static const std::uint64_t factor = std::uint64_t(std::random_device()()) << 32 | std::random_device()() | 1;
  const std::size_t slots = std::bit_ceil(2 * positions.size() + 1);
  const auto slot_of = [&](const Vec3d& p) {
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {  // adding 0 turns -0 into 0
      hash = (hash ^ std::bit_cast<std::uint64_t>(p[k] + 0.0)) * factor;
      hash ^= hash >> 32;
    }
    return std::size_t(hash) & (slots - 1);
  };
  std::vector<std::int32_t> first(slots, -1), number(positions.size());
  std::int32_t count = 0;
  for (std::size_t corner = 0; corner < positions.size(); ++corner) {
    std::size_t slot = slot_of(positions[corner]);
    while (first[slot] >= 0 && positions[first[slot]] != positions[corner]) slot = (slot + 1) & (slots - 1);
    const bool is_first = first[slot] < 0;
    if (is_first) first[slot] = static_cast<std::int32_t>(corner);
    number[corner] = is_first ? count++ : number[first[slot]];
  }
  return number;
}

std::vector<std::int32_t> split_non_manifold_vertices(const std::vector<std::int32_t>& weld,
                                                      const std::vector<std::int32_t>& triangles) {
  const std::size_t vertices = weld.empty() ? 0 : std::size_t(*std::max_element(weld.begin(), weld.end())) + 1;
  DisjointSets sets = manifold_surfaces(sorted_half_edges(weld, vertices, triangles), weld.size() / 3);
  struct Corner {
    std::int32_t weld, surface, corner;
    auto vertex() const { return std::tie(weld, surface); }
    auto order() const { return std::tie(surface, corner); }
  };
  std::vector<Corner> corners;
  corners.reserve(triangles.size() * 3);
  for (const std::int32_t triangle : triangles) {
    for (int i = 0; i < 3; ++i) corners.push_back({weld[3 * triangle + i], sets.find(triangle), 3 * triangle + i});
  }
  corners = sorted_by(&Corner::weld, vertices, corners);
  std::vector<std::int32_t> number(weld.size(), -1);
  std::int32_t count = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i > 0 && corners[i].vertex() != corners[i - 1].vertex()) ++count;
    number[corners[i].corner] = count;
  }
  return number;
}

}  // namespace patchlight

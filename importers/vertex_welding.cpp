#include "importers/vertex_welding.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace patchlight {
namespace {

/// One triangle's way through an edge.
struct EdgeUse {
  std::int32_t low = 0;  ///< Vertices.
  std::int32_t high = 0;
  std::int32_t triangle = 0;
  bool upward = false;  ///< From low to high.

  auto edge() const { return std::tie(low, high); }
  auto order() const { return std::tie(low, high, triangle); }
};

std::vector<EdgeUse> sorted_edge_uses(const std::vector<std::int32_t>& weld,
                                      const std::vector<std::int32_t>& triangles) {
  std::vector<EdgeUse> uses;
  uses.reserve(triangles.size() * 3);
  for (const std::int32_t triangle : triangles) {
    for (int i = 0; i < 3; ++i) {
      const std::int32_t from = weld[3 * triangle + i];
      const std::int32_t to = weld[3 * triangle + (i + 1) % 3];
      uses.push_back({std::min(from, to), std::max(from, to), triangle, from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) { return a.order() < b.order(); });
  return uses;
}

/// Sets of triangles that belong to one surface.
DisjointSets surfaces(const std::vector<EdgeUse>& uses, std::size_t triangles) {
  DisjointSets sets(triangles);
  for (std::size_t begin = 0; begin < uses.size();) {
    std::size_t end = begin + 1;
    while (end < uses.size() && uses[end].edge() == uses[begin].edge()) ++end;
    if (end - begin == 2 && uses[begin].upward != uses[begin + 1].upward) {
      sets.join(uses[begin].triangle, uses[begin + 1].triangle);
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
  std::vector<std::int32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0);
  // Comparison takes -0 for 0.
  const auto coordinates = [&](std::int32_t corner) {
    const Vec3d& p = positions[corner];
    return std::tie(p.x, p.y, p.z);
  };
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    const auto pa = coordinates(a);
    const auto pb = coordinates(b);
    return pa < pb || (pa == pb && a < b);
  });
  std::vector<std::int32_t> first(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && coordinates(order[i]) == coordinates(order[i - 1]);
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  std::vector<std::int32_t> number(positions.size());
  std::int32_t count = 0;
  for (std::size_t corner = 0; corner < positions.size(); ++corner) {
    const bool is_first = first[corner] == static_cast<std::int32_t>(corner);
    number[corner] = is_first ? count++ : number[first[corner]];
  }
  return number;
}

std::vector<std::int32_t> part_surfaces(const std::vector<std::int32_t>& weld,
                                        const std::vector<std::int32_t>& triangles) {
  DisjointSets sets = surfaces(sorted_edge_uses(weld, triangles), weld.size() / 3);
  struct Corner {
    std::int32_t weld, surface, corner;
    auto vertex() const { return std::tie(weld, surface); }
    auto order() const { return std::tie(weld, surface, corner); }
  };
  std::vector<Corner> corners;
  corners.reserve(triangles.size() * 3);
  for (const std::int32_t triangle : triangles) {
    for (int i = 0; i < 3; ++i) corners.push_back({weld[3 * triangle + i], sets.find(triangle), 3 * triangle + i});
  }
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.order() < b.order(); });
  std::vector<std::int32_t> number(weld.size(), -1);
  std::int32_t count = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i > 0 && corners[i].vertex() != corners[i - 1].vertex()) ++count;
    number[corners[i].corner] = count;
  }
  return number;
}

}  // namespace patchlight

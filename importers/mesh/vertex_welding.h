#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// Union-find over the numbers from 0 to count - 1; a set's representative is its smallest member.
struct DisjointSets {
  explicit DisjointSets(std::size_t count);

  std::vector<std::int32_t> parent;

  std::int32_t find(std::int32_t member);
  void join(std::int32_t a, std::int32_t b);
};

/// Vertex number of each corner: equal positions share one. Numbered by first appearance; -0 equals 0.
std::vector<std::int32_t> weld_corners(const std::vector<Vec3d>& positions);

/// Splits vertices at non-manifold places. Triangles stay connected through edges that exactly two of them use, in
/// opposite directions; everywhere else they get separate vertices.
/// `weld`: vertex numbers of all corners. `triangles`: the ones in use. Returns new vertex numbers of their corners, -1
/// for all others.
std::vector<std::int32_t> split_non_manifold_vertices(const std::vector<std::int32_t>& weld,
                                                      const std::vector<std::int32_t>& triangles);

}  // namespace patchlight

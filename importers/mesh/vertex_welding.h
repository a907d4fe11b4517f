#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// Disjoint sets of numbers from 0; a set is known by its least member.
struct DisjointSets {
  explicit DisjointSets(std::size_t count);

  std::vector<std::int32_t> parent;

  std::int32_t find(std::int32_t member);
  void join(std::int32_t a, std::int32_t b);
};

/// For each corner the number of its position, in order of first appearance; -0 is 0.
std::vector<std::int32_t> weld_corners(const std::vector<Vec3d>& positions);

/// Parts vertices where surfaces touch: triangles that are connected through edges of exactly two of them, which run
/// through it in opposite directions, keep common vertices; all others get vertices of their own.
/// `weld` numbers the corners of all triangles; `triangles` are those in use. Returns new numbers for their corners.
std::vector<std::int32_t> part_surfaces(const std::vector<std::int32_t>& weld,
                                        const std::vector<std::int32_t>& triangles);

}  // namespace patchlight

#pragma once
#include <vector>

namespace patchlight {

/// Where the rays of half a row start and go, before a patch shifts them: Hammersley points for the directions, which
/// stand in Morton order so that sixteen that follow each other go much the same way, and the best known Kronecker
/// sequence for the starting points.
struct DirectionTable {
  /// `count`: a multiple of 16.
  explicit DirectionTable(int count);

  int count() const { return int(x.size()); }

  std::vector<float> x, y;  ///< [count], in [0,1): as cosine_direction takes them.
  std::vector<float> u, v;  ///< [count], in [0,1): as PatchSampler takes them.
};

}  // namespace patchlight

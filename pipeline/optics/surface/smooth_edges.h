#pragma once
#include <cstdint>
#include <unordered_map>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Finds the edges of quads that join other quads smoothly.
class SmoothEdges {
 public:
  explicit SmoothEdges(const std::vector<Primitive>& primitives);

  bool is_smooth(const Primitive& primitive) const;
  /// Edges 0 to 3 are at v = 0, u = 1, v = 1, u = 0.
  bool is_smooth(const Primitive& primitive, int edge) const;

 private:
  std::unordered_map<std::uint64_t, int> count_;
};

}  // namespace patchlight

#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Where the rays of half a row start and go, before a row turns them: the first points of Sobol's sequence in four
/// dimensions (Joe and Kuo 2008), as 32 bits of a number in [0,1) each. They stand in Morton order of their directions,
/// so that sixteen that follow each other go much the same way.
///
/// The points of a later block of the sequence are these, each coordinate changed by exclusive or with the block's
/// shift.
struct DirectionTable {
  /// `count`: a multiple of 16.
  explicit DirectionTable(int count);

  int count() const { return int(x.size()); }

  /// What turns the table into the sequence's block of this index.
  std::array<std::uint32_t, 4> block(std::uint32_t index) const;

  std::vector<std::uint32_t> x, y;  ///< [count]: as cosine_direction takes them.
  std::vector<std::uint32_t> u, v;  ///< [count]: as PatchSampler takes them.
};

/// 32 bits as a number in [0,1).
inline float unit_of(std::uint32_t bits) {
  return float(std::int32_t(bits >> 8)) * 0x1p-24f;
}

}  // namespace patchlight

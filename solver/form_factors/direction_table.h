#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Origins and directions of the rays of a sample set before its random digital shift: the first points of the
/// sequence of sobol4(). They are in Morton order of their directions, so that sixteen consecutive rays are coherent.
///
/// A later block of the sequence has the same points, after exclusive or of each coordinate with the block's shift.
struct DirectionTable {
  /// `count`: a multiple of 16.
  explicit DirectionTable(int count);

  int count() const { return int(x.size()); }

  /// The shift that turns the table into the block of this index.
  std::array<std::uint32_t, 4> block(std::uint32_t index) const;

  std::vector<std::uint32_t> x, y;  ///< [count] Arguments of cosine_direction.
  std::vector<std::uint32_t> u, v;  ///< [count] Arguments of PatchSampler.
};

}  // namespace patchlight

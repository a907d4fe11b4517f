#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// A set of cells of the unit square that samples of an emitter, or of directions, come from: the cells whose samples
/// are known to be visible.
class VisibleCells {
 public:
  static constexpr int kSide = 32;  ///< Cells along a side.

  void add(const Vec2f& at) { rows_[index(at.y)] |= 1u << index(at.x); }
  bool contains(const Vec2f& at) const { return rows_[index(at.y)] >> index(at.x) & 1u; }

  /// Adds other cells and the cells around them.
  void add_with_border(const VisibleCells& other) {
    for (int y = 0; y < kSide; ++y) {
      const std::uint32_t row = other.rows_[y], wide = row | row << 1 | row >> 1;
      for (int v = std::max(0, y - 1); v <= std::min(kSide - 1, y + 1); ++v) rows_[v] |= wide;
    }
  }

  /// Adds the cells at most `across` cells to the side and `up` cells above and below.
  void widen(int across, int up) {
    const auto rows = rows_;
    auto wide = rows;
    for (int k = 1; k <= across; ++k)
      for (int y = 0; y < kSide; ++y) wide[y] |= rows[y] << k | rows[y] >> k;
    rows_ = wide;
    for (int k = 1; k <= up; ++k)
      for (int y = k; y < kSide; ++y) {
        rows_[y] |= wide[y - k];
        rows_[y - k] |= wide[y];
      }
  }

  /// Lower corners of the cells, row by row, in cells.
  std::vector<std::array<std::uint8_t, 2>> corners() const {
    std::vector<std::array<std::uint8_t, 2>> list;
    list.reserve(kSide * kSide);
    for (int y = 0; y < kSide; ++y)
      for (std::uint32_t row = rows_[y]; row != 0; row &= row - 1)
        list.push_back({std::uint8_t(std::countr_zero(row)), std::uint8_t(y)});
    return list;
  }

 private:
  static int index(float x) { return std::clamp(int(x * kSide), 0, kSide - 1); }

  std::array<std::uint32_t, kSide> rows_{};
};

/// Samples a set of cells uniformly. Lists them once for many samples.
class CellSampler {
 public:
  /// `cells`: at least one.
  explicit CellSampler(const VisibleCells& cells) : corners_(cells.corners()) {}

  /// Fraction of the unit square, in (0,1].
  float area() const { return float(corners_.size()) / float(VisibleCells::kSide * VisibleCells::kSide); }

  /// Maps uniform points of the unit square to uniform points of the cells.
  Vec2f operator()(const Vec2f& at) const {
    const float place = at.x * float(corners_.size());
    const auto k = std::min(std::size_t(place), corners_.size() - 1);
    return Vec2f(float(corners_[k][0]) + (place - float(k)), float(corners_[k][1]) + at.y) / float(VisibleCells::kSide);
  }

 private:
  std::vector<std::array<std::uint8_t, 2>> corners_;
};

}  // namespace patchlight

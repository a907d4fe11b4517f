#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/model/cuts/cut_cells.h"

namespace patchlight {

/// Finds the patch at (u,v) of a primitive, by its rows of cells and the cuts through them.
///
/// Rows of a quad have the same number of cells of equal size; those of a region, only some of them. Rows of a sphere
/// are rings of equal polar angle; their numbers of cells differ. A facet of a cluster has one cell.
class PatchLookup {
 public:
  struct Row {
    std::int32_t first;  ///< Patch of the cell at u = 0; of a region, its number among the cells of regions.
    std::int32_t cells;  ///< Number of cells.
    bool has_cuts;
    bool in_region;
  };

  explicit PatchLookup(const PatchSet& scene);

  /// Number of rows of primitive `i`; rows have growing v.
  int rows(std::int32_t i) const { return int(starts_[i + 1] - starts_[i]); }
  const Row& row(std::int32_t i, int k) const { return rows_[starts_[i] + k]; }

  /// The patch at (u,v) of primitive `i`; u and v in [0,1].
  std::int32_t patch(std::int32_t i, float u, float v) const {
    const Row& at = row(i, cell(v, rows(i)));
    const std::int32_t patch = nearest(at, cell(u, at.cells));
    return at.has_cuts && cut_of_[patch] >= 0 ? part(cut_of_[patch], u, v) : patch;
  }

  /// The patch of a cell of a row; -1 outside of the region.
  std::int32_t at(const Row& row, int column) const {
    const std::int32_t patch = row.in_region ? region_cells_[row.first + column] : row.first + column;
    return patch < 0 ? -1 : patch;
  }

  /// The same, but outside of the region the patch of a cell near by.
  std::int32_t nearest(const Row& row, int column) const {
    if (!row.in_region) return row.first + column;
    const std::int32_t patch = region_cells_[row.first + column];
    return patch < 0 ? ~patch : patch;
  }

  /// [cells of regions] Patches; ~patch of a cell near by where there is none.
  const std::vector<std::int32_t>& region_cells() const { return region_cells_; }

  /// Whether anything stands on the edges between four cells of a quad's grid, or cuts one of them: the cells from
  /// (column, row) to (column + 1, row + 1), as far as they are in the grid.
  bool is_open(std::int32_t i, int column, int row) const {
    if (closed_.empty()) return true;
    const int last_column = this->row(i, 0).cells - 1, last_row = rows(i) - 1;
    const int left = column < 0 ? 0 : column, right = column < last_column ? column + 1 : last_column;
    const int low = row < 0 ? 0 : row, high = row < last_row ? row + 1 : last_row;
    const auto closed = [&](int x, int y) {
      const std::int32_t patch = at(this->row(i, y), x);
      return patch < 0 ? 0 : int(closed_[patch]);
    };
    return !(left < right && (closed(left, low) | closed(left, high)) & 2) &&
           !(low < high && (closed(left, low) | closed(right, low)) & 4);
  }

  /// Edges of the cell of a patch in the grid on which anything stands, or which lead to a cell that is cut, as bits of
  /// Patch::closed; all edges of a cut cell.
  std::uint8_t closed_edges(std::int32_t patch) const { return closed_.empty() ? 0 : closed_[patch]; }

  /// The part at (u,v) of the cell that patch `i` is, or is a part of.
  std::int32_t part_of_cell(std::int32_t i, float u, float v) const {
    return cut_of_.empty() || cut_of_[i] < 0 ? i : part(cut_of_[i], u, v);
  }

  const std::vector<CutLine>& lines() const { return lines_; }         ///< As PatchSet::cuts.
  const std::vector<std::int32_t>& cut_of() const { return cut_of_; }  ///< [patches] Patch::cut; empty: no cuts.

  /// The cell of x in [0,1], among `count` equal cells.
  static int cell(float x, int count) {
    const int k = int(x * float(count));
    return k < 0 ? 0 : (k >= count ? count - 1 : k);
  }

 private:
  std::int32_t add_region(const PatchSet& scene, std::int32_t first);
  void add_cuts(const PatchSet& scene);
  void add_closed_edges(const PatchSet& scene);

  std::int32_t part(std::int32_t cut, float u, float v) const {
    while (cut >= 0) cut = lines_[cut].sides[lines_[cut].side(u, v)];
    return ~cut;
  }

  std::vector<std::uint32_t> starts_;
  std::vector<Row> rows_;
  std::vector<std::int32_t> region_cells_;
  std::vector<CutLine> lines_;        ///< As PatchSet::cuts.
  std::vector<std::int32_t> cut_of_;  ///< [patches] Patch::cut; empty: no cuts.
  std::vector<std::uint8_t> closed_;  ///< [patches] See closed_edges(); empty: no edges are closed.
};

}  // namespace patchlight

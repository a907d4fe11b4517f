#include "pipeline/optics/sampling/patch_lookup.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {

namespace {

/// The number of cells along an edge by the size of one in (u,v).
int cells_of_size(float size) {
  return std::max(1, int(std::lround(1.0 / double(size))));
}

}  // namespace

PatchLookup::PatchLookup(const PatchSet& scene) {
  starts_.reserve(scene.primitives.size() + 1);
  rows_.reserve(scene.primitives.size());
  std::int32_t patch = 0;
  const auto count = std::int32_t(scene.patches.size());
  for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) {
    starts_.push_back(std::uint32_t(rows_.size()));
    if (patch < count && scene.patches[patch].facets > 0) {
      rows_.push_back({patch, 1, false, false});
      if (i + 1 == scene.patches[patch].primitive + scene.patches[patch].facets) ++patch;
      continue;
    }
    if (scene.primitives[i].region) {
      patch = add_region(scene, patch);
      continue;
    }
    for (bool in_grid = true; in_grid && patch < count && scene.patches[patch].primitive == i;) {
      const std::int32_t first = patch;
      const float v0 = scene.patches[first].v0;
      bool has_cuts = false;
      while (patch < count && scene.patches[patch].primitive == i && scene.patches[patch].v0 == v0 &&
             (patch == first || scene.patches[patch - 1].u1 < 1))
        has_cuts |= scene.patches[patch++].cut >= 0;
      rows_.push_back({first, patch - first, has_cuts, false});
      in_grid = scene.patches[first].v1 < 1;
    }
    while (patch < count && scene.patches[patch].primitive == i) ++patch;  // further parts of cut cells
  }
  starts_.push_back(std::uint32_t(rows_.size()));
  if (!scene.cuts.empty()) add_cuts(scene);
  add_closed_edges(scene);
}

/// Adds the rows of a region, whose first patch is given. Returns the first patch after its own.
std::int32_t PatchLookup::add_region(const PatchSet& scene, std::int32_t first) {
  const Patch& patch = scene.patches[first];
  const int columns = cells_of_size(patch.u1 - patch.u0), rows = cells_of_size(patch.v1 - patch.v0);
  const auto start = std::int32_t(region_cells_.size());
  constexpr std::int32_t kUnknown = Cut::kNothing;
  region_cells_.resize(region_cells_.size() + std::size_t(columns) * rows, kUnknown);
  for (int row = 0; row < rows; ++row) rows_.push_back({start + row * columns, columns, false, true});
  std::vector<std::int32_t> reached;
  const std::int32_t primitive = patch.primitive;
  std::int32_t i = first;
  for (; i < std::int32_t(scene.patches.size()) && scene.patches[i].primitive == primitive; ++i) {
    const Patch& p = scene.patches[i];
    const int row = cell(0.5f * (p.v0 + p.v1), rows), column = cell(0.5f * (p.u0 + p.u1), columns);
    Row& of_cell = rows_[rows_.size() - std::size_t(rows - row)];
    of_cell.has_cuts |= p.cut >= 0;
    std::int32_t& at = region_cells_[of_cell.first + column];
    if (at != kUnknown) continue;  // a further part of a cut cell
    at = i;
    reached.push_back(row * columns + column);
  }
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const int row = reached[k] / columns, column = reached[k] % columns;
    const std::int32_t near = region_cells_[start + reached[k]];
    for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
      const int x = column + dx, y = row + dy;
      if (x < 0 || y < 0 || x >= columns || y >= rows) continue;
      std::int32_t& next = region_cells_[start + y * columns + x];
      if (next != kUnknown) continue;
      next = near < 0 ? near : ~near;
      reached.push_back(y * columns + x);
    }
  }
  return i;
}

void PatchLookup::add_closed_edges(const PatchSet& scene) {
  const auto is_closed = [](const Patch& patch) { return patch.closed != 0 || patch.cut >= 0; };
  if (std::none_of(scene.patches.begin(), scene.patches.end(), is_closed)) return;
  closed_.reserve(scene.patches.size());
  for (const Patch& patch : scene.patches) closed_.push_back(patch.cut >= 0 ? 15 : patch.closed);
  for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) {
    if (scene.primitives[i].shape == Primitive::Shape::sphere) continue;
    const auto join = [](std::uint8_t& a, std::uint8_t bit_of_a, std::uint8_t& b, std::uint8_t bit_of_b) {
      if (((a & bit_of_a) | (b & bit_of_b)) == 0) return;
      a |= bit_of_a;
      b |= bit_of_b;
    };
    for (int y = 0; y < rows(i); ++y)
      for (int x = 0; x < row(i, y).cells; ++x) {
        const std::int32_t patch = at(row(i, y), x), left = x > 0 ? at(row(i, y), x - 1) : -1,
                           below = y > 0 ? at(row(i, y - 1), x) : -1;
        if (patch >= 0 && left >= 0) join(closed_[patch], 8, closed_[left], 2);
        if (patch >= 0 && below >= 0) join(closed_[patch], 1, closed_[below], 4);
      }
  }
}

void PatchLookup::add_cuts(const PatchSet& scene) {
  lines_.resize(scene.cuts.size());
  cut_of_.reserve(scene.patches.size());
  std::int32_t last = -1;  // the parts of a cell that are not in the grid follow each other
  for (const Patch& patch : scene.patches) {
    cut_of_.push_back(patch.cut);
    if (patch.cut < 0 || patch.cut == last) continue;
    const Primitive& primitive = scene.primitives[patch.primitive];
    set_lines(scene.cuts, last = patch.cut, primitive, *PlaneFrame::of(primitive), lines_);
  }
}

}  // namespace patchlight

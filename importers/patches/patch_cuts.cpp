#include "importers/patches/patch_cuts.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pipeline/model/cuts/cut_cells.h"
#include "pipeline/model/cuts/region_shape.h"
#include "pipeline/optics/cuts/cell_cutter.h"
#include "pipeline/optics/surface/lattices.h"
#include "pipeline/optics/surface/smooth_edges.h"

namespace patchlight {
namespace {

constexpr double kWhole = 0.25;        // area of primitives that are not cut, over the patch area
constexpr double kLeastOfCell = 1e-6;  // of a part of a cell that lies in its region
constexpr double kSmall = 0.25;        // extent of crossings that do not cut, over the size of a cell

bool has_picture_of_light(const PatchSet& scene, const Primitive& p) {
  return p.emission_texture >= 0 || (p.shader >= 0 && is_set(scene.shaders[p.shader].emission));
}

/// Whether edges of a cell are closed: bits of Patch::closed.
std::uint8_t closed_edges(const CellCutter& cutter, const Primitive& primitive, const PlaneFrame& frame,
                          const Patch& patch) {
  std::array<Vec2d, 4> corners;
  for (int k = 0; k < 4; ++k)
    corners[k] = frame.to_plane(
        position_at(primitive.corners, k == 1 || k == 2 ? patch.u1 : patch.u0, k >= 2 ? patch.v1 : patch.v0));
  std::uint8_t closed = 0;
  for (int k = 0; k < 4; ++k) {
    const Vec2d &a = corners[k], &b = corners[(k + 1) % 4];
    if (a != b && cutter.is_closed(a, b)) closed |= std::uint8_t(1 << k);
  }
  return closed;
}

/// Appends the parts of a patch's cell, but the largest, to `others`, and the cuts to `cuts`. The largest becomes the
/// patch itself, whose index is `index`; the others' indices begin with `next`. `region`: null for a whole quad.
void cut_patch(const CellParts& cell, const PlaneFrame& frame, const RegionShape* region, std::int32_t index,
               std::int32_t next, Patch& patch, std::vector<Patch>& others, std::vector<Cut>& cuts) {
  Patch whole = patch;
  whole.cut = std::int32_t(cuts.size());
  std::vector<Patch> parts(cell.parts.size(), whole);
  std::size_t largest = 0;
  double cell_area = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    cell_area += area_of(cell.parts[k]);
    set_part(region ? region->inside(cell.parts[k]) : std::vector<Polygon>{cell.parts[k]}, frame, parts[k]);
    if (parts[k].area > parts[largest].area) largest = k;
  }
  std::vector<std::int32_t> sides(parts.size(), Cut::kNothing);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (region && !(parts[k].area > kLeastOfCell * cell_area)) continue;
    sides[k] = ~(k == largest ? index : next++);
    (k == largest ? patch : others.emplace_back()) = std::move(parts[k]);
  }
  for (const Cut& of_cell : cell.cuts) {
    Cut& cut = cuts.emplace_back(of_cell);
    for (std::int32_t& side : cut.sides) side = side >= 0 ? whole.cut + side : sides[std::size_t(~side)];
  }
}

/// Marks the edges between quads whose grids continue each other, where others stand on them. `largest`: see
/// cut_patches().
void close_edges_of_quads(const std::vector<double>& largest, PatchSet& scene) {
  const PatchLookup lookup(scene);
  const Lattices lattices(scene, lookup);
  if (lattices.empty()) return;
  std::vector<double> reach(scene.primitives.size(), -1.0);
  for (const auto& quads : lattices.quads())
    for (const std::int32_t i : quads) reach[i] = CellCutter::kHighest * largest[i];
  const auto crossings = find_crossings_at_edges(scene.primitives, [&](std::int32_t i) { return reach[i]; });
  for (Patch& patch : scene.patches) {
    if (crossings[patch.primitive].empty() || patch.cut >= 0) continue;
    const Primitive& primitive = scene.primitives[patch.primitive];
    const CellCutter cutter(crossings[patch.primitive], kSmall, position_rounding(primitive));
    patch.closed |= closed_edges(cutter, primitive, *PlaneFrame::of(primitive), patch);
  }
}

}  // namespace

void cut_patches(const std::vector<PatchTarget>& targets, PatchSet& scene) {
  std::vector<double> largest(scene.primitives.size(), 0.0);  // patch of each primitive: root of its area, m
  std::vector<bool> is_strip(scene.primitives.size());        // has one row or one column of patches
  for (const Patch& patch : scene.patches) {
    largest[patch.primitive] = std::max(largest[patch.primitive], std::sqrt(patch.area));
    if (patch.u1 - patch.u0 == 1 || patch.v1 - patch.v0 == 1) is_strip[patch.primitive] = true;
  }
  const SmoothEdges smooth(scene.primitives);
  const std::vector<bool> is_facet = facets_of_clusters(scene);
  const auto crossings = find_crossings(scene.primitives, [&](std::int32_t i) {
    const Primitive& p = scene.primitives[i];
    const bool is_whole = is_facet[i] || has_picture_of_light(scene, p) ||
                          primitive_area(p) < kWhole * targets[i].area || (is_strip[i] && smooth.is_smooth(p));
    return is_whole ? -1.0 : CellCutter::kHighest * largest[i];
  });
  std::vector<Patch> patches;
  patches.reserve(scene.patches.size());
  for (std::size_t from = 0; from < scene.patches.size();) {
    const std::int32_t i = scene.patches[from].primitive;
    std::size_t to = from;
    while (to < scene.patches.size() && scene.patches[to].primitive == i) ++to;
    const std::size_t first = patches.size();
    patches.insert(patches.end(), scene.patches.begin() + std::ptrdiff_t(from),
                   scene.patches.begin() + std::ptrdiff_t(to));
    from = to;
    if (crossings[i].empty()) continue;
    const Primitive& primitive = scene.primitives[i];
    const PlaneFrame frame = *PlaneFrame::of(primitive);
    const CellCutter cutter(crossings[i], kSmall, position_rounding(primitive));
    std::optional<RegionShape> region;
    if (primitive.region) region.emplace(primitive, frame);
    std::vector<Patch> others;
    const std::size_t last = patches.size();
    for (std::size_t k = first; k < last; ++k) {
      Patch& patch = patches[k];
      patch.closed = closed_edges(cutter, primitive, frame, patch);
      const CellParts cell = cutter.cut(cell_polygon(primitive, frame, patch));
      if (!cell.cuts.empty())
        cut_patch(cell, frame, region ? &*region : nullptr, std::int32_t(k), std::int32_t(last + others.size()), patch,
                  others, scene.cuts);
    }
    patches.insert(patches.end(), others.begin(), others.end());
  }
  scene.patches = std::move(patches);
  close_edges_of_quads(largest, scene);
}

}  // namespace patchlight

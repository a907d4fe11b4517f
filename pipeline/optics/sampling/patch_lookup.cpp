#include "pipeline/optics/sampling/patch_lookup.h"

#include <algorithm>

namespace patchlight {

PatchLookup::PatchLookup(const PatchSet& scene) {
  starts_.reserve(scene.primitives.size() + 1);
  std::int32_t patch = 0;
  const auto count = std::int32_t(scene.patches.size());
  for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) {
    starts_.push_back(std::uint32_t(rows_.size()));
    for (bool in_grid = true; in_grid && patch < count && scene.patches[patch].primitive == i;) {
      const std::int32_t first = patch;
      const float v0 = scene.patches[first].v0;
      bool has_cuts = false;
      while (patch < count && scene.patches[patch].primitive == i && scene.patches[patch].v0 == v0 &&
             (patch == first || scene.patches[patch - 1].u1 < 1))
        has_cuts |= scene.patches[patch++].cut >= 0;
      rows_.push_back({first, patch - first, has_cuts});
      in_grid = scene.patches[first].v1 < 1;
    }
    while (patch < count && scene.patches[patch].primitive == i) ++patch;  // further parts of cut cells
  }
  starts_.push_back(std::uint32_t(rows_.size()));
  if (!scene.cuts.empty()) add_cuts(scene);
  add_closed_edges(scene);
}

void PatchLookup::add_closed_edges(const PatchSet& scene) {
  const auto is_closed = [](const Patch& patch) { return patch.closed != 0 || patch.cut >= 0; };
  if (std::none_of(scene.patches.begin(), scene.patches.end(), is_closed)) return;
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
        std::uint8_t& at = closed_[row(i, y).first + x];
        if (x > 0) join(at, 8, closed_[row(i, y).first + x - 1], 2);
        if (y > 0) join(at, 1, closed_[row(i, y - 1).first + x], 4);
      }
  }
}

void PatchLookup::add_cuts(const PatchSet& scene) {
  lines_.resize(scene.cuts.size());
  std::int32_t last = -1;  // the parts of a cell that are not in the grid follow each other
  for (const Patch& patch : scene.patches) {
    cut_of_.push_back(patch.cut);
    if (patch.cut < 0 || patch.cut == last) continue;
    const Primitive& primitive = scene.primitives[patch.primitive];
    set_lines(scene.cuts, last = patch.cut, primitive, *PlaneFrame::of(primitive), lines_);
  }
}

}  // namespace patchlight

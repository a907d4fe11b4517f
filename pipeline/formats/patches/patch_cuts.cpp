#include "pipeline/formats/patches/patch_cuts.h"

#include <algorithm>
#include <cmath>

#include "pipeline/model/cuts/cut_cells.h"

namespace patchlight {

namespace {

constexpr double kAreaRounding = 1e-3;  // of the area of a part, relative to the larger of both

bool is_same_cell(const Patch& a, const Patch& b) {
  return a.primitive == b.primitive && a.cut == b.cut && a.u0 == b.u0 && a.v0 == b.v0 && a.u1 == b.u1 && a.v1 == b.v1;
}

/// Marks the patches and cuts of the tree of `first`'s cell. Returns whether it is valid so far.
bool visit_cell(const PatchSet& scene, const Patch& first, std::vector<bool>& cuts, std::vector<bool>& patches) {
  std::vector<std::int32_t> todo{first.cut};
  while (!todo.empty()) {
    const std::int32_t at = todo.back();
    todo.pop_back();
    if (at == Cut::kNothing && scene.primitives[first.primitive].region) continue;
    if (at < 0) {
      const auto patch = std::size_t(~at);
      if (patch >= patches.size() || patches[patch] || !is_same_cell(first, scene.patches[patch])) return false;
      patches[patch] = true;
      continue;
    }
    if (std::size_t(at) >= cuts.size() || cuts[at]) return false;
    cuts[at] = true;
    for (const std::int32_t side : scene.cuts[at].sides) {
      if (side >= 0 && side <= at) return false;
      todo.push_back(side);
    }
  }
  return true;
}

}  // namespace

void write_cut_datasets(H5Writer& writer, const PatchSet& scene) {
  const auto is_closed = [](const Patch& patch) { return patch.closed != 0; };
  if (std::any_of(scene.patches.begin(), scene.patches.end(), is_closed)) {
    std::vector<std::int32_t> closed;
    for (const Patch& patch : scene.patches) closed.push_back(patch.closed);
    writer.dataset<std::int32_t>("/patches/closed", closed);
  }
  if (scene.cuts.empty()) return;
  std::vector<std::int32_t> of_patches, sides;
  std::vector<double> lines;
  for (const Patch& patch : scene.patches) of_patches.push_back(patch.cut);
  for (const Cut& cut : scene.cuts) {
    lines.insert(lines.end(), {cut.from.x, cut.from.y, cut.to.x, cut.to.y});
    sides.insert(sides.end(), cut.sides.begin(), cut.sides.end());
  }
  writer.dataset<std::int32_t>("/patches/cut", of_patches);
  writer.dataset<double>("/cuts/line", lines, 4);
  writer.dataset<std::int32_t>("/cuts/sides", sides, 2);
}

void read_cut_datasets(const H5Reader& reader, PatchSet& scene) {
  const auto patches = std::int64_t(scene.patches.size());
  if (reader.has("/patches/closed")) {
    const auto closed = reader.dataset<std::int32_t>("/patches/closed", patches);
    for (std::size_t i = 0; i < closed.size(); ++i) {
      if (closed[i] < 0 || closed[i] > 15) reader.refuse("a value outside [0, 15]", "/patches/closed");
      scene.patches[i].closed = std::uint8_t(closed[i]);
    }
  }
  if (!reader.has("/cuts/line")) return;
  const auto lines = reader.dataset<double>("/cuts/line", -1, 4);
  const auto sides = reader.dataset<std::int32_t>("/cuts/sides", std::int64_t(lines.size() / 4), 2);
  const auto of_patches = reader.dataset<std::int32_t>("/patches/cut", patches);
  for (std::size_t k = 0; k < sides.size() / 2; ++k)
    scene.cuts.push_back(
        {{lines[4 * k], lines[4 * k + 1]}, {lines[4 * k + 2], lines[4 * k + 3]}, {sides[2 * k], sides[2 * k + 1]}});
  for (std::size_t i = 0; i < of_patches.size(); ++i) scene.patches[i].cut = of_patches[i];
}

PatchFault cut_fault(const PatchSet& scene) {
  const PatchFault not_a_tree{"cuts that are not one tree for each cut cell", "/cuts/sides"};
  for (const Cut& cut : scene.cuts)
    if (!(std::isfinite((cut.to - cut.from).length()) && (cut.to - cut.from).length() > 0))
      return {"a line that is not finite, or has no length", "/cuts/line"};
  std::vector<bool> cuts(scene.cuts.size()), patches(scene.patches.size());
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    const Patch& patch = scene.patches[i];
    if (patch.cut < -1 || patch.cut >= std::int32_t(scene.cuts.size()))
      return {"an index out of range", "/patches/cut"};
    if (patch.cut < 0 || patches[i]) continue;
    if (!PlaneFrame::of(scene.primitives[patch.primitive])) return {"cuts of what is not plane", "/patches/cut"};
    if (!visit_cell(scene, patch, cuts, patches) || !patches[i]) return not_a_tree;
  }
  return std::find(cuts.begin(), cuts.end(), false) != cuts.end() ? not_a_tree : PatchFault{};
}

PatchFault area_fault(const PatchSet& scene) {
  for (const Patch& patch : scene.patches) {
    if (patch.triangles.empty() && patch.cut < 0) continue;
    if (patch.triangles.empty()) return {"cuts that leave a patch without an area", "/cuts/line"};
    double area = 0;
    for (std::size_t k = 0; k < patch.triangles.size(); k += 3) {
      const Vec3d* const corner = &patch.triangles[k];
      area += 0.5 * ((corner[1] - corner[0]) % (corner[2] - corner[0])).length();
    }
    if (!(area > 0 && std::abs(area - patch.area) <= kAreaRounding * std::max(area, patch.area)))
      return {"an area that is not that of the patch's part of its cell", "/patches/area"};
  }
  return {};
}

}  // namespace patchlight

#include "importers/patches/large_surfaces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "importers/patches/patch_areas.h"
#include "importers/patches/patch_grid.h"
#include "importers/patches/size_field.h"
#include "pipeline/model/cuts/region_shape.h"
#include "pipeline/optics/surface/smooth_edges.h"

namespace patchlight {
namespace {

constexpr int kLeastLevel = 4;    // halvings at which a surface is divided
constexpr int kMostLevel = 24;    // of halvings
constexpr double kVariety = 6.0;  // of a piece that is not divided: its extent over its patches' size

/// A range of cells of a quad's grid, of which each is halved `level` times.
struct Range {
  int level = 0;
  std::int64_t u0 = 0, v0 = 0, u1 = 0, v1 = 0;

  Range halved(int times) const { return {level + times, u0 << times, v0 << times, u1 << times, v1 << times}; }
};

/// A piece of a quad: the (u,v) of its corners and its grid of patches.
struct Piece {
  std::array<Vec2d, 4> corners;
  QuadGrid grid;
};

/// Divides one quad.
class Divider {
 public:
  /// `size`: wanted size of its patches, m. `coarser`: factor of the sizes that the field asks for.
  Divider(const SizeField& field, const Primitive& quad, double size, double coarser)
      : field_(field), quad_(quad), coarser_(coarser), grid_(quad_grid(quad, size * size)) {
    const auto& c = quad.corners;
    const double along = std::max((c[1] - c[0]).length(), (c[2] - c[3]).length()) / grid_.columns;
    const double across = std::max((c[3] - c[0]).length(), (c[2] - c[1]).length()) / grid_.rows;
    size_ = std::min(size, std::max(along, across));
  }

  /// The pieces in their order; none if the quad stays whole. Where they have more than `most` patches, some that do.
  std::vector<Piece> pieces(double most) const {
    const Range whole{0, 0, 0, grid_.columns, grid_.rows};
    std::vector<Piece> pieces;
    if (level_for(whole) < kLeastLevel) return pieces;
    for (const Range& range : divided(whole, most))
      pieces.push_back({corners(range), {std::int32_t(range.u1 - range.u0), std::int32_t(range.v1 - range.v0)}});
    return pieces;
  }

 private:
  /// (u,v) of the corners of a range.
  std::array<Vec2d, 4> corners(const Range& range) const {
    const auto columns = double(std::int64_t(grid_.columns) << range.level);
    const auto rows = double(std::int64_t(grid_.rows) << range.level);
    const double u0 = double(range.u0) / columns, u1 = double(range.u1) / columns;
    const double v0 = double(range.v0) / rows, v1 = double(range.v1) / rows;
    return {Vec2d(u0, v0), Vec2d(u1, v0), Vec2d(u1, v1), Vec2d(u0, v1)};
  }

  std::array<Vec3d, 4> positions(const Range& range) const {
    const std::array<Vec2d, 4> uv = corners(range);
    std::array<Vec3d, 4> result;
    for (int k = 0; k < 4; ++k) result[k] = position_at(quad_.corners, uv[k].x, uv[k].y);
    return result;
  }

  int level_for(const Range& range) const {
    const double least = coarser_ * field_.at(positions(range), quad_.back >= 0, size_ / coarser_);
    return std::clamp(int(std::floor(std::log2(size_ / least) + 0.3)), 0, kMostLevel);
  }

  /// `most`: of the patches, less those so far; negative: no more ranges.
  std::vector<Range> divided(const Range& range, double& most) const {
    if (most < 0) return {};
    const auto finished = [&](const Range& result) {
      most -= double(result.u1 - result.u0) * double(result.v1 - result.v0);
      return std::vector{result};
    };
    const int level = level_for(range);
    if (level <= range.level) return finished(range);
    const std::array<Vec3d, 4> c = positions(range);
    const double extent = std::max((c[2] - c[0]).length(), (c[3] - c[1]).length());
    if (extent < kVariety * std::ldexp(size_, -level)) return finished(range.halved(level - range.level));
    const Range whole = range.u1 - range.u0 == 1 && range.v1 - range.v0 == 1 ? range.halved(1) : range;
    Range first = whole, second = whole;
    const double along = (c[1] - c[0]).length() + (c[2] - c[3]).length();
    const double across = (c[3] - c[0]).length() + (c[2] - c[1]).length();
    if (whole.v1 - whole.v0 == 1 || (whole.u1 - whole.u0 > 1 && along >= across)) {
      first.u1 = second.u0 = (whole.u0 + whole.u1) / 2;
    } else {
      first.v1 = second.v0 = (whole.v0 + whole.v1) / 2;
    }
    std::vector<Range> ranges = divided(first, most);
    const std::vector<Range> others = divided(second, most);
    if (ranges.size() == 1 && others.size() == 1 && ranges[0].level == others[0].level)
      return {whole.halved(ranges[0].level - whole.level)};
    ranges.insert(ranges.end(), others.begin(), others.end());
    return ranges;
  }

  const SizeField& field_;
  const Primitive& quad_;
  double coarser_;
  QuadGrid grid_;
  double size_;  ///< Of its patches, m; of a small quad its longest side.
};

/// Values at the corners of a piece of a quad, bilinear between the quad's.
template <class Value>
std::array<Value, 4> values_at(const std::array<Value, 4>& of_quad, const std::array<Vec2d, 4>& at) {
  using Scalar = typename Value::BaseType;
  std::array<Value, 4> result;
  for (int k = 0; k < 4; ++k) {
    const auto u = Scalar(at[k].x), v = Scalar(at[k].y);
    result[k] = (of_quad[0] * (1 - u) + of_quad[1] * u) * (1 - v) + (of_quad[3] * (1 - u) + of_quad[2] * u) * v;
  }
  return result;
}

/// (u,v) of a piece's corners on the back of its quad.
std::array<Vec2d, 4> mirrored(const std::array<Vec2d, 4>& uv, const std::array<std::size_t, 4>& order) {
  std::array<Vec2d, 4> result;
  for (std::size_t k = 0; k < 4; ++k) result[k] = {1.0 - uv[order[k]].x, uv[order[k]].y};
  return result;
}

/// Builds a list of primitives again, some of them in pieces.
class Rebuilder {
 public:
  Rebuilder(const PrimitiveList& before, const std::vector<double>& areas)
      : before_(before), areas_(areas), has_texcoords_(!before.texcoords.empty()) {}

  void copy(std::int32_t i) {
    const std::array<Vec2d, 4> whole{Vec2d(0, 0), Vec2d(1, 0), Vec2d(1, 1), Vec2d(0, 1)};
    add(before_.primitives[i], {areas_[i]}, i, whole);
  }

  /// Adds a piece of quad `i`, with its corners' (u,v) and its grid; then, for a quad with a back, the back's. Of a
  /// region, only what there is of the piece.
  void add_piece(std::int32_t i, const std::array<Vec2d, 4>& uv, const QuadGrid& grid) {
    const PatchTarget target{areas_[i], grid};
    Primitive part = before_.primitives[i];
    for (std::size_t k = 0; k < 4; ++k) part.corners[k] = position_at(before_.primitives[i].corners, uv[k].x, uv[k].y);
    if (before_.primitives[i].is_triangle() && uv[2].y == 1.0) part.corners[3] = part.corners[2];
    part.smooth_vertices = vertices_of(part);
    if (part.region) {
      constexpr double kLeast = 1e-9, kWhole = 1 - 1e-9;  // of the piece's area
      const Region region = part_of(*part.region, uv[0], uv[2]);
      if (region.area() < kLeast) return;
      part.region = region.area() > kWhole ? nullptr : std::make_shared<const Region>(region);
    }
    add(part, target, i, uv);
    if (part.back < 0) return;
    const auto order = reversed_corners(part);
    Primitive back = before_.primitives[i + 1];
    for (std::size_t k = 0; k < 4; ++k) back.corners[k] = part.corners[order[k]];
    back.smooth_vertices = vertices_of(back);
    back.region = part.region ? std::make_shared<const Region>(part.region->mirrored()) : nullptr;
    add(back, target, i + 1, mirrored(uv, order));
    join_sides();
  }

  /// Makes the last two primitives the two sides of a surface.
  void join_sides() {
    const auto count = std::int32_t(list_.primitives.size());
    list_.primitives[count - 2].back = count - 1;
    list_.primitives[count - 1].back = count - 2;
  }

  /// Puts the new primitives into the list. Returns their targets.
  std::vector<PatchTarget> finish(PrimitiveList& list) {
    list.primitives = std::move(list_.primitives);
    list.texcoords = std::move(list_.texcoords);
    list.emission_texcoords = std::move(list_.emission_texcoords);
    list.metallic_roughness_texcoords = std::move(list_.metallic_roughness_texcoords);
    list.normal_texcoords = std::move(list_.normal_texcoords);
    list.colors = std::move(list_.colors);
    list.normals = std::move(list_.normals);
    list.smooth_vertices += new_vertices_;
    return std::move(targets_);
  }

 private:
  /// Adds a primitive: part of primitive `i` with corners at (u,v).
  void add(const Primitive& primitive, const PatchTarget& target, std::int32_t i, const std::array<Vec2d, 4>& uv) {
    if (primitive.shader >= 0 && target.grid.columns > 0 && !has_texcoords_) {
      has_texcoords_ = true;  // a shader's u and v are those of the whole
      list_.texcoords.assign(list_.primitives.size(), kIdentityTexcoords);
    }
    if (has_texcoords_)
      list_.texcoords.push_back(values_at(before_.texcoords.empty() ? kIdentityTexcoords : before_.texcoords[i], uv));
    const auto interpolate = [&](const auto& values, auto& result) {
      if (!values.empty()) result.push_back(values_at(values[i], uv));
    };
    interpolate(before_.emission_texcoords, list_.emission_texcoords);
    interpolate(before_.metallic_roughness_texcoords, list_.metallic_roughness_texcoords);
    interpolate(before_.normal_texcoords, list_.normal_texcoords);
    interpolate(before_.colors, list_.colors);
    interpolate(before_.normals, list_.normals);
    if (!list_.normals.empty())
      for (Vec3f& normal : list_.normals.back()) normal.normalize();  // zeros stay
    list_.primitives.push_back(primitive);
    targets_.push_back(target);
  }

  /// New smooth vertices for a piece: it has creases all around.
  std::array<std::int32_t, 4> vertices_of(const Primitive& piece) {
    std::array<std::int32_t, 4> result;
    for (std::int32_t& vertex : result) vertex = before_.smooth_vertices + new_vertices_++;
    if (piece.is_triangle()) result[3] = result[2];
    return result;
  }

  const PrimitiveList& before_;
  const std::vector<double>& areas_;
  bool has_texcoords_;
  PrimitiveList list_;
  std::vector<PatchTarget> targets_;
  std::int32_t new_vertices_ = 0;
};

/// Whether a primitive may be divided.
bool is_divisible(const Primitive& p, const SurfaceMaterial& material, double patch_area, const SmoothEdges& smooth) {
  if (p.shape != Primitive::Shape::quad || p.light_group >= 0) return false;
  if (material.specular != Color(0.0f) || material.patch_area > 0.0) return false;
  const QuadGrid grid = quad_grid(p, patch_area);
  return (grid.columns > 1 && grid.rows > 1) || !smooth.is_smooth(p);
}

/// The pieces of the quads that are to be divided, by their index; none if they would add more patches than `most`.
using Pieces = std::map<std::int32_t, std::vector<Piece>>;
std::optional<Pieces> find_pieces(const PrimitiveList& list, const std::vector<bool>& divisible,
                                  const std::vector<double>& patch_areas, const SizeField& field, double coarser,
                                  double most) {
  Pieces result;
  double added = 0.0;
  for (std::int32_t i = 0; i < std::int32_t(list.primitives.size()); ++i) {
    const Primitive& front = list.primitives[i];
    if (!divisible[i] || (front.back >= 0 && front.back < i)) continue;
    const double whole = patch_count(front, patch_areas[i]);
    std::vector<Piece> pieces = Divider(field, front, std::sqrt(patch_areas[i]), coarser).pieces(most + whole);
    if (pieces.empty()) continue;
    double count = 0.0;
    for (const Piece& piece : pieces) count += double(piece.grid.columns) * piece.grid.rows;
    added += (count - whole) * (front.back >= 0 ? 2.0 : 1.0);
    if (added > most) return {};
    result.emplace(i, std::move(pieces));
  }
  return result;
}

}  // namespace

std::vector<PatchTarget> divide_large_surfaces(const std::vector<SurfaceMaterial>& materials,
                                               const std::vector<double>& patch_areas, const ImportConfig& config,
                                               PrimitiveList& list) {
  Pieces pieces;
  if (!config.patch_area) {
    const SizeField field(list.primitives, patch_areas);
    const SmoothEdges smooth(list.primitives);
    std::vector<bool> divisible;
    double count = 0.0;
    for (std::size_t i = 0; i < list.primitives.size(); ++i) {
      const Primitive& p = list.primitives[i];
      count += patch_count(p, patch_areas[i]);
      divisible.push_back(is_divisible(p, materials[p.material], patch_areas[i], smooth));
    }
    const double most = std::min(kDefaultPatches * config.accuracy, std::max(0.0, double(config.max_patches) - count));
    std::optional<Pieces> found;
    for (double coarser = 1.0; !found; coarser *= 2.0)
      found = find_pieces(list, divisible, patch_areas, field, coarser, most);
    pieces = std::move(*found);
  }
  Rebuilder rebuilder(list, patch_areas);
  for (std::int32_t i = 0; i < std::int32_t(list.primitives.size()); ++i) {
    const bool has_back = list.primitives[i].back == i + 1;
    if (const auto found = pieces.find(i); found != pieces.end()) {
      for (const Piece& piece : found->second) rebuilder.add_piece(i, piece.corners, piece.grid);
      if (has_back) ++i;
      continue;
    }
    rebuilder.copy(i);
    if (!has_back) continue;
    rebuilder.copy(++i);
    rebuilder.join_sides();
  }
  return rebuilder.finish(list);
}

}  // namespace patchlight

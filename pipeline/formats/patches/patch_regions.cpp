#include "pipeline/formats/patches/patch_regions.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

constexpr double kRounding = 1e-9;       // of (u,v)
constexpr double kBend = 1e-15;          // of a corner that may turn inwards by rounding: the area it leaves out, twice
constexpr double kParallelogram = 1e-6;  // distance of a corner from that of a parallelogram, over its diagonal

bool in_box(const Vec2d& p) {
  return p.x >= -kRounding && p.y >= -kRounding && p.x <= 1 + kRounding && p.y <= 1 + kRounding;  // false for NaN
}

bool is_convex(const std::array<Vec2d, 4>& c) {
  const int corners = c[2] == c[3] ? 3 : 4;
  for (int k = 0; k < corners; ++k) {
    const Vec2d &a = c[k], &b = c[(k + 1) % corners];
    if (!((b - a).cross(c[(k + 2) % corners] - b) >= -kBend)) return false;
  }
  return (c[2] - c[0]).cross(c[3] - c[1]) > 0;
}

}  // namespace

void write_region_datasets(H5Writer& writer, const PatchSet& scene) {
  std::vector<std::int32_t> primitives, counts;
  std::vector<double> pieces, edges;
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    const auto& region = scene.primitives[i].region;
    if (!region) continue;
    primitives.push_back(std::int32_t(i));
    counts.insert(counts.end(), {std::int32_t(region->pieces.size()), std::int32_t(region->edges.size())});
    for (const auto& piece : region->pieces)
      for (const Vec2d& corner : piece) pieces.insert(pieces.end(), {corner.x, corner.y});
    for (const auto& edge : region->edges)
      for (const Vec2d& end : edge) edges.insert(edges.end(), {end.x, end.y});
  }
  if (primitives.empty()) return;
  writer.dataset<std::int32_t>("/regions/primitive", primitives);
  writer.dataset<std::int32_t>("/regions/counts", counts, 2);
  writer.dataset<double>("/regions/piece", pieces, 2, 4);
  writer.dataset<double>("/regions/edge", edges, 2, 2);
}

void read_region_datasets(const H5Reader& reader, const std::vector<bool>& is_region, PatchSet& scene) {
  const auto wanted = std::count(is_region.begin(), is_region.end(), true);
  if (wanted == 0) return;
  const auto primitives = reader.dataset<std::int32_t>("/regions/primitive", wanted);
  const auto counts = reader.dataset<std::int32_t>("/regions/counts", wanted, 2);
  const auto pieces = reader.dataset<double>("/regions/piece", -1, 2, 4);
  const auto edges = reader.dataset<double>("/regions/edge", -1, 2, 2);
  std::size_t next_piece = 0, next_edge = 0;
  for (std::size_t r = 0; r < primitives.size(); ++r) {
    const auto i = std::size_t(primitives[r]);
    if (primitives[r] < 0 || i >= is_region.size() || !is_region[i] || scene.primitives[i].region)
      reader.refuse("an index that is not of a region", "/regions/primitive");
    const std::int64_t piece_count = counts[2 * r], edge_count = counts[2 * r + 1];
    if (piece_count < 1 || edge_count < 0 || piece_count > std::int64_t((pieces.size() - next_piece) / 8) ||
        edge_count > std::int64_t((edges.size() - next_edge) / 4))
      reader.refuse("a number out of bounds", "/regions/counts");
    Region region;
    for (std::int64_t k = 0; k < piece_count; ++k)
      for (Vec2d& corner : region.pieces.emplace_back()) {
        corner = {pieces[next_piece], pieces[next_piece + 1]};
        next_piece += 2;
      }
    for (std::int64_t k = 0; k < edge_count; ++k)
      for (Vec2d& end : region.edges.emplace_back()) {
        end = {edges[next_edge], edges[next_edge + 1]};
        next_edge += 2;
      }
    scene.primitives[i].region = std::make_shared<const Region>(std::move(region));
  }
  if (next_piece != pieces.size() || next_edge != edges.size())
    reader.refuse("pieces or edges that no region has", "/regions/counts");
}

PatchFault region_fault(const PatchSet& scene) {
  for (const Primitive& p : scene.primitives) {
    if (p.back >= 0 && (p.region == nullptr) != (scene.primitives[p.back].region == nullptr))
      return {"two sides of which one is a region", "/primitives/type"};
    if (!p.region) continue;
    const auto& c = p.corners;
    if ((c[0] + c[2] - c[1] - c[3]).length() > kParallelogram * (c[2] - c[0]).length() || p.mask >= 0)
      return {"a region whose corners are not those of a parallelogram, or with a mask", "/primitives/corners"};
    for (const auto& piece : p.region->pieces)
      if (!std::all_of(piece.begin(), piece.end(), in_box) || !is_convex(piece))
        return {"a piece that is not convex, or out of bounds", "/regions/piece"};
    for (const auto& [from, to] : p.region->edges)
      if (!in_box(from) || !in_box(to)) return {"an edge out of bounds", "/regions/edge"};
  }
  return {};
}

}  // namespace patchlight

#include "solver/display/display_vertices.h"

#include <algorithm>
#include <cmath>

#include "pipeline/model/cuts/cut_cells.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

namespace {

constexpr float kNudge = 0.02f;       // of a leaf: distance of vertices from edges, where surfaces may meet
constexpr float kLargest = 0.125f;    // of a patch: leaves that are larger count as that
constexpr double kNudgeOfHeight = 3;  // of an edge's height above a face: what it covers is narrower
constexpr double kNudgeOfRoom = 0.3;  // of the distance to the far edges of a vertex's faces

}  // namespace

std::int32_t DisplayVertices::at(const VertexKey& key, const Leaf& leaf, std::int32_t patch, const Vec2f& uv,
                                 const Surroundings& around) {
  const auto [found, is_new] = numbers_.try_emplace(key, std::int32_t(mesh_.vertices.size()));
  const std::int32_t number = found->second;
  if (is_new) {
    const Vec2f half = leaf.step * (0.5f * float(leaf.size));
    const bool border = is_border(scene_.patches[leaf.patch].primitive, uv, half, around);
    mesh_.vertices.push_back({patch, uv.x, uv.y});
    places_.push_back({border ? Kind::border : Kind::hidden, leaf.step, std::numeric_limits<float>::infinity(),
                       VertexKeyHash()(key), around});
  }
  Place& place = places_[number];
  if (place.kind == Kind::hidden && is_open_[patch]) place.kind = Kind::gathered;
  const bool on_cut = key.grid < 0 && key.grid != VertexKey::kOfPoints;  // that is not a crossing: nothing stands there
  const float cells = on_cut ? 0.0f : std::min(float(leaf.size), kLargest * float(kFinestCells));
  place.size = std::min(place.size, cells);
  place.around.room = std::min(place.around.room, around.room);
  return number;
}

void DisplayVertices::move_off_edges() {
  const auto nudged = [](float x, float size, std::uint64_t random) {
    const float shift = kNudge * size * (random & 1 ? 1.0f : -1.0f);
    return x + shift < 0.0f || x + shift > 1.0f ? x - shift : x + shift;
  };
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const Place& place = places_[k];
    const Sectors& sectors = place.around.sectors;
    DisplayMesh::Vertex& vertex = mesh_.vertices[k];
    if (sectors.parted()) {
      const std::int32_t i = scene_.patches[vertex.patch].primitive;
      const Primitive& primitive = scene_.primitives[i];
      const PlaneFrame frame = *PlaneFrame::of(primitive);
      const double cell = std::sqrt(area_of(cell_polygon(primitive, frame, scene_.patches[vertex.patch])));
      const double shift = std::min(std::max(double(kNudge * kLargest) * cell, kNudgeOfHeight * sectors.height),
                                    kNudgeOfRoom * place.around.room);
      const Imath::V2d uv = uv_of(primitive, frame.to_world(sectors.at + sectors.middle(place.around.sector) * shift));
      vertex.u = std::clamp(float(uv.x), 0.0f, 1.0f);
      vertex.v = std::clamp(float(uv.y), 0.0f, 1.0f);
      vertex.patch = lookup_.patch(i, vertex.u, vertex.v);
    } else if (place.kind == Kind::gathered) {
      vertex.u = nudged(vertex.u, place.size * place.step.x, place.random);
      vertex.v = nudged(vertex.v, place.size * place.step.y, place.random >> 1);
    }
  }
}

/// Whether a vertex lies on an undivided patch, or on an edge shared smoothly with a neighbour.
bool DisplayVertices::is_border(std::int32_t i, const Vec2f& at, const Vec2f& reach, const Surroundings& around) const {
  const Primitive& primitive = scene_.primitives[i];
  const bool sphere = primitive.shape == Primitive::Shape::sphere;
  for (const float y : {at.y - reach.y, at.y + reach.y})
    for (float x : {at.x - reach.x, at.x + reach.x}) {
      if (sphere) x -= std::floor(x);
      if (around.sectors.parted()) {
        const Vec2d to = PlaneFrame::of(primitive)->to_plane(position_at(primitive.corners, x, y)) - around.sectors.at;
        if (around.sectors.of(to) != around.sector) continue;
      }
      const int edge = y < 0 ? 0 : x > 1 ? 1 : y > 1 ? 2 : x < 0 ? 3 : -1;
      if (edge >= 0 && !sphere && !lattices_.empty()) {
        const int columns = lookup_.row(i, 0).cells, rows = lookup_.rows(i);
        const std::int32_t beyond =
            lattices_.beyond(i, int(std::floor(x * float(columns))), int(std::floor(y * float(rows))));
        if (beyond >= 0 && mesh_.roots[beyond] < 0) return true;
        if (beyond >= 0) continue;
      }
      if (edge < 0 ? mesh_.roots[lookup_.patch(i, x, y)] < 0 : !sphere && smooth_.is_smooth(primitive, edge))
        return true;
    }
  return false;
}

void DisplayVertices::sort() {
  std::vector<std::int32_t> order, number(places_.size());
  const auto add = [&](auto is_next) {
    for (std::int32_t i = 0; i < std::int32_t(places_.size()); ++i)
      if (is_next(places_[i].kind)) order.push_back(i);
  };
  add([](Kind kind) { return kind == Kind::gathered; });
  mesh_.gathered = std::int32_t(order.size());
  add([](Kind kind) { return kind == Kind::border || kind == Kind::hidden; });
  for (const auto& m : midpoints_) order.push_back(m[0]);
  std::vector<DisplayMesh::Vertex> vertices;
  for (std::size_t k = 0; k < order.size(); ++k) {
    number[order[k]] = std::int32_t(k);
    vertices.push_back(mesh_.vertices[order[k]]);
  }
  mesh_.vertices = std::move(vertices);
  for (const auto& m : midpoints_) mesh_.midpoints.push_back({number[m[1]], number[m[2]]});
  for (std::int32_t& corner : mesh_.corners) corner = number[corner];
}

}  // namespace patchlight

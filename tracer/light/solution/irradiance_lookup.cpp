#include "tracer/light/solution/irradiance_lookup.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/surface/lattices.h"

namespace patchlight {

namespace {

Color positive(const Color& c) {
  return Color(std::max(c.x, 0.0f), std::max(c.y, 0.0f), std::max(c.z, 0.0f));
}

Color mix(const Color& a, const Color& b, float t) {
  return a * (1.0f - t) + b * t;
}

/// Edges of a quad, as pairs of corners in the direction of growing u or v.
struct Edge {
  int from, to;
};
constexpr std::array<Edge, 4> kEdges{{{0, 1}, {1, 2}, {3, 2}, {0, 3}}};  // v = 0, u = 1, v = 1, u = 0

}  // namespace

/// Computes the cell values of one light group at a time.
class IrradianceLookup::Builder {
 public:
  Builder(const PatchSet& scene, const PatchLookup& lookup, const SmoothEdges& smooth)
      : scene_(scene),
        lookup_(lookup),
        smooth_(smooth),
        lattices_(scene, lookup, smooth),
        vertices_(smooth.vertices()) {
    grids_.reserve(scene.primitives.size());
    for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) count_at_vertices(i);
    for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) add_grid(i);
    cells_.resize(cell_count_);
  }

  std::size_t cell_count() const { return cell_count_; }
  std::vector<Grid> grids() && { return std::move(grids_); }

  /// Cell values for one light group. `irradiance`: [patches].
  const std::vector<Color>& cells(const std::vector<Color>& irradiance) {
    irradiance_ = &irradiance;
    std::fill(vertices_.begin(), vertices_.end(), VertexSum());
    for (std::int32_t i = 0; i < std::int32_t(grids_.size()); ++i) add_to_vertices(i);
    for (std::int32_t i = 0; i < std::int32_t(grids_.size()); ++i) {
      if (grids_[i].columns < 0) fill_facet(i);
      if (grids_[i].columns > 0) fill_cells(i);
    }
    return cells_;
  }

 private:
  struct VertexSum {
    Color sum{0.0f};
    float count = 0.0f;
  };

  const Color& cell(std::int32_t i, int column, int row) const {
    return (*irradiance_)[lookup_.nearest(lookup_.row(i, row), column)];
  }

  /// Cell `k` along an edge.
  const Color& edge_cell(std::int32_t i, int edge, int k) const {
    const int last_row = lookup_.rows(i) - 1, last_column = lookup_.row(i, 0).cells - 1;
    switch (edge) {
      case 0:
        return cell(i, k, 0);
      case 1:
        return cell(i, last_column, k);
      case 2:
        return cell(i, k, last_row);
      default:
        return cell(i, 0, k);
    }
  }
  int edge_cells(std::int32_t i, int edge) const { return edge % 2 == 0 ? lookup_.row(i, 0).cells : lookup_.rows(i); }

  /// Whether an edge runs from the larger smooth vertex to the smaller.
  bool is_reversed(std::int32_t i, int edge) const {
    const auto& ids = scene_.primitives[i].smooth_vertices;
    return ids[kEdges[edge].from] > ids[kEdges[edge].to];
  }

  bool has_smooth_vertices(std::int32_t i) const {
    const Primitive& p = scene_.primitives[i];
    return p.shape == Primitive::Shape::quad && p.smooth_vertices[0] >= 0;
  }

  void count_at_vertices(std::int32_t i) {
    if (!has_smooth_vertices(i)) return;
    const auto& ids = scene_.primitives[i].smooth_vertices;
    for (int k = 0; k < (scene_.primitives[i].is_triangle() ? 3 : 4); ++k) vertices_[ids[k]].count += 1;
  }

  void add_grid(std::int32_t i) {
    Grid grid;
    grid.first = cell_count_;
    grid.rows = lookup_.rows(i);
    if (scene_.primitives[i].shape == Primitive::Shape::quad) {
      grid.columns = lookup_.row(i, 0).cells;
      if (grid.columns == 1 && grid.rows == 1 && meets_smoothly(i)) grid.columns = -1;
      cell_count_ += grid.columns < 0 ? 4 : std::size_t(grid.columns + 2) * (grid.rows + 2);
    }
    grids_.push_back(grid);
  }

  void add_to_vertices(std::int32_t i) {
    if (!has_smooth_vertices(i)) return;
    const auto& ids = scene_.primitives[i].smooth_vertices;
    const int last_row = lookup_.rows(i) - 1, last_column = lookup_.row(i, 0).cells - 1;
    for (int k = 0; k < (scene_.primitives[i].is_triangle() ? 3 : 4); ++k) {
      VertexSum& vertex = vertices_[ids[k]];
      vertex.sum += cell(i, k == 1 || k == 2 ? last_column : 0, k >= 2 ? last_row : 0);
      vertex.count += 1;
    }
  }

  bool meets_smoothly(std::int32_t i) const {
    const auto& ids = scene_.primitives[i].smooth_vertices;
    return std::any_of(ids.begin(), ids.end(), [&](std::int32_t id) { return id >= 0 && vertices_.at(id).count > 1; });
  }

  void fill_facet(std::int32_t i) {
    const auto& ids = scene_.primitives[i].smooth_vertices;
    Color* cell = cells_.data() + grids_[i].first;
    for (const int k : {0, 1, 3, 2}) {
      const VertexSum& vertex = vertices_.at(ids[k]);
      *cell++ = vertex.sum / vertex.count;
    }
  }

  /// Value of the margin cell beyond cell `k` of an edge: that of the cell that continues the grid, interpolated from
  /// the smooth neighbour's cells, or extrapolated linearly from the last two cells.
  Color margin_value(std::int32_t i, int edge, int k, const Color& last, const Color& before) const {
    const int column = edge % 2 == 0 ? k : edge == 1 ? lookup_.row(i, 0).cells : -1;
    const int row = edge % 2 != 0 ? k : edge == 2 ? lookup_.rows(i) : -1;
    if (const std::int32_t beyond = lattices_.beyond(i, column, row); beyond >= 0) return (*irradiance_)[beyond];
    if (const auto sides = smooth_.sides(scene_.primitives[i], edge); sides.size() == 2) {
      const SmoothEdges::Side& other = sides[sides[0].primitive == i && sides[0].edge == edge ? 1 : 0];
      const int count = edge_cells(other.primitive, other.edge);
      float t = (float(k) + 0.5f) / float(edge_cells(i, edge));
      if (is_reversed(other.primitive, other.edge) != is_reversed(i, edge)) t = 1.0f - t;
      const float x = std::clamp(t * float(count) - 0.5f, 0.0f, float(count - 1));
      const int low = std::min(int(x), std::max(count - 2, 0));
      return mix(edge_cell(other.primitive, other.edge, low),
                 edge_cell(other.primitive, other.edge, std::min(low + 1, count - 1)), x - float(low));
    }
    return positive(last * 2.0f - before);
  }

  void fill_cells(std::int32_t i) {
    const int nu = grids_[i].columns, nv = grids_[i].rows, stride = nu + 2;
    Color* origin = cells_.data() + grids_[i].first;
    const auto at = [&](int column, int row) -> Color& { return origin[(row + 1) * stride + column + 1]; };
    for (int row = 0; row < nv; ++row)
      for (int column = 0; column < nu; ++column) at(column, row) = cell(i, column, row);
    // The second cell from an edge; the first where anything stands between them.
    const auto before = [&](int column, int row, int edge, int to_column, int to_row) {
      const bool closed = lookup_.closed_edges(lookup_.nearest(lookup_.row(i, row), column)) >> edge & 1;
      return closed ? at(column, row) : at(std::clamp(to_column, 0, nu - 1), std::clamp(to_row, 0, nv - 1));
    };
    for (int k = 0; k < nu; ++k) {
      at(k, -1) = margin_value(i, 0, k, at(k, 0), before(k, 0, 2, k, 1));
      at(k, nv) = margin_value(i, 2, k, at(k, nv - 1), before(k, nv - 1, 0, k, nv - 2));
    }
    for (int k = 0; k < nv; ++k) {
      at(-1, k) = margin_value(i, 3, k, at(0, k), before(0, k, 1, 1, k));
      at(nu, k) = margin_value(i, 1, k, at(nu - 1, k), before(nu - 1, k, 3, nu - 2, k));
    }
    for (const int row : {-1, nv})
      for (const int column : {-1, nu}) {
        const int c = std::clamp(column, 0, nu - 1), r = std::clamp(row, 0, nv - 1);
        const std::int32_t beyond = lattices_.beyond(i, column, row);
        at(column, row) = beyond >= 0 ? (*irradiance_)[beyond] : positive(at(c, row) + at(column, r) - at(c, r));
      }
  }

  const PatchSet& scene_;
  const PatchLookup& lookup_;
  const SmoothEdges& smooth_;
  const Lattices lattices_;
  const std::vector<Color>* irradiance_ = nullptr;
  std::vector<Grid> grids_;
  std::size_t cell_count_ = 0;
  std::vector<Color> cells_;
  std::vector<VertexSum> vertices_;  ///< By smooth vertex.
};

IrradianceLookup::IrradianceLookup(const PatchSet& scene, const PatchLookup& lookup, const SmoothEdges& smooth,
                                   const GroupIrradiance& group_irradiance, const std::vector<LightMix>& mixes)
    : lookup_(lookup), mixes_(mixes.size()) {
  Builder builder(scene, lookup, smooth);
  for (Values& values : mixes_) {
    values.patches.assign(scene.patches.size(), Color(0.0f));
    values.cells.assign(builder.cell_count(), Color(0.0f));
  }
  const auto add = [](const std::vector<Color>& values, const Color& weight, std::vector<Color>& sums) {
    for (std::size_t k = 0; k < values.size(); ++k) sums[k] += values[k] * weight;
  };
  for (std::size_t g = 0; g < scene.light_groups.size(); ++g) {
    const std::vector<Color> irradiance = group_irradiance(g);
    const std::vector<Color>& cells = builder.cells(irradiance);
    for (std::size_t m = 0; m < mixes.size(); ++m) {
      add(irradiance, mixes[m][g], mixes_[m].patches);
      add(cells, mixes[m][g], mixes_[m].cells);
    }
  }
  grids_ = std::move(builder).grids();
}

Color IrradianceLookup::operator()(std::int32_t i, float u, float v, std::size_t mix_index) const {
  const Grid& grid = grids_[i];
  const Values& values = mixes_[mix_index];
  if (grid.columns == 0) return on_sphere(i, u, v, values);
  const Color* cells = values.cells.data() + grid.first;
  const auto own = [&] { return values.patches[lookup_.patch(i, u, v)]; };
  if (grid.columns < 0 && lookup_.closed_edges(lookup_.nearest(lookup_.row(i, 0), 0)) != 0) return own();
  if (grid.columns < 0) return mix(mix(cells[0], cells[1], u), mix(cells[2], cells[3], u), v);
  const float x = u * float(grid.columns) + 0.5f, y = v * float(grid.rows) + 0.5f;
  const int column = std::clamp(int(x), 0, grid.columns), row = std::clamp(int(y), 0, grid.rows);
  if (!lookup_.is_open(i, column - 1, row - 1)) return own();
  const int stride = grid.columns + 2;
  const Color* at = cells + row * stride + column;
  const float s = x - float(column), t = y - float(row);
  return positive(mix(mix(at[0], at[1], s), mix(at[stride], at[stride + 1], s), t));
}

Color IrradianceLookup::on_ring(const PatchLookup::Row& ring, float u, const Values& values) const {
  const float x = u * float(ring.cells) - 0.5f;
  const float low = std::floor(x);
  const int a = (int(low) + ring.cells) % ring.cells, b = (a + 1) % ring.cells;
  return mix(values.patches[ring.first + a], values.patches[ring.first + b], x - low);
}

Color IrradianceLookup::on_sphere(std::int32_t i, float u, float v, const Values& values) const {
  const int rings = lookup_.rows(i);
  const float y = v * float(rings) - 0.5f;
  const int low = std::clamp(int(std::floor(y)), 0, rings - 1), high = std::min(low + 1, rings - 1);
  const float outside = y < 0 ? -y : y - float(rings - 1);
  if (outside <= 0)
    return mix(on_ring(lookup_.row(i, low), u, values), on_ring(lookup_.row(i, high), u, values), y - float(low));
  const PatchLookup::Row& ring = lookup_.row(i, y < 0 ? 0 : rings - 1);
  Color mean(0.0f);
  for (int k = 0; k < ring.cells; ++k) mean += values.patches[ring.first + k];
  return mix(on_ring(ring, u, values), mean / float(ring.cells), std::min(2.0f * outside, 1.0f));
}

}  // namespace patchlight

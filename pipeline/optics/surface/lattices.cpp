#include "pipeline/optics/surface/lattices.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace patchlight {

namespace {

using Node = Lattices::Node;

constexpr double kRounding = 1.0 / (1 << 20);  // of positions, relative to their coordinates
constexpr double kShape = 1e-5;                // difference of positions and of cells' shapes, over their size

/// Outwards across the edges of a cell: at v = 0, u = 1, v = 1, u = 0.
constexpr std::array<Node, 4> kOutwards{{{0, -1}, {1, 0}, {0, 1}, {-1, 0}}};

int edge_of(const Node& outwards) {
  return int(std::find(kOutwards.begin(), kOutwards.end(), outwards) - kOutwards.begin());
}

}  // namespace

class Lattices::Builder {
 public:
  Builder(const PatchSet& scene, const PatchLookup& lookup, const SmoothEdges& smooth)
      : scene_(scene), lookup_(lookup) {
    const std::vector<bool> is_facet = facets_of_clusters(scene);
    double largest = 0;
    for (std::int32_t i = 0; i < std::int32_t(scene.primitives.size()); ++i) {
      const Primitive& p = scene.primitives[i];
      if (p.shape != Primitive::Shape::quad || p.is_triangle() || lookup.rows(i) == 0 || is_facet[i]) continue;
      if (lookup.rows(i) == 1 && lookup.row(i, 0).cells == 1 && smooth.is_smooth(p)) continue;
      const Vec3d along = p.corners[1] - p.corners[0], across = p.corners[3] - p.corners[0];
      const Grid grid{i,
                      lookup.row(i, 0).cells,
                      lookup.rows(i),
                      p.corners[0],
                      along / lookup.row(i, 0).cells,
                      across / lookup.rows(i)};
      if ((p.corners[0] + along + across - p.corners[2]).length() > kShape * grid.size()) continue;
      for (const Vec3d& c : p.corners) largest = std::max({largest, std::abs(c.x), std::abs(c.y), std::abs(c.z)});
      grids_.push_back(grid);
    }
    tolerance_ = kRounding * largest;
  }

  void build(Lattices& result) {
    add_edges();
    find_neighbours();
    for (std::size_t g = 0; g < grids_.size(); ++g)
      if (!neighbours_[g].empty() && !result.frames_.contains(grids_[g].quad)) add_lattice(std::int32_t(g), result);
  }

 private:
  /// The grid of a parallelogram.
  struct Grid {
    std::int32_t quad;
    int nu, nv;
    Vec3d corner, u, v;  ///< Its first corner; steps to the next column and row, m.

    Vec3d at(const Node& node) const { return corner + u * double(node.x) + v * double(node.y); }
    double size() const { return std::min(u.length(), v.length()); }
  };

  /// An edge of a cell at the border of a grid.
  struct Edge {
    std::uint64_t key;  ///< Of the region around its middle.
    std::int32_t grid;  ///< Index.
    Node from, to;      ///< On the grid.
    Node outwards;
  };

  /// A pair of edges in one place.
  struct Neighbour {
    std::int32_t grid;
    const Edge *own, *other;
  };

  void add_edges() {
    for (std::size_t g = 0; g < grids_.size(); ++g) {
      const auto add = [&](const Node& from, const Node& to, const Node& outwards) {
        if (!ends_at_whole_cell(grids_[g], from, to, outwards)) return;
        Edge& edge = edges_.emplace_back(Edge{0, std::int32_t(g), from, to, outwards});
        edge.key = region(middle_of(edge), {});
      };
      const int nu = grids_[g].nu, nv = grids_[g].nv;
      for (int k = 0; k < nu; ++k) {
        add({k, 0}, {k + 1, 0}, kOutwards[0]);
        add({k, nv}, {k + 1, nv}, kOutwards[2]);
      }
      for (int k = 0; k < nv; ++k) {
        add({nu, k}, {nu, k + 1}, kOutwards[1]);
        add({0, k}, {0, k + 1}, kOutwards[3]);
      }
    }
    std::stable_sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) { return a.key < b.key; });
  }

  /// Whether the cell inside of an edge is not a part that a region's outline leaves of it.
  bool ends_at_whole_cell(const Grid& grid, const Node& from, const Node& to, const Node& outwards) const {
    const auto column = int(std::min(from.x, to.x) - (outwards.x > 0 ? 1 : 0));
    const auto row = int(std::min(from.y, to.y) - (outwards.y > 0 ? 1 : 0));
    const std::int32_t patch = lookup_.at(lookup_.row(grid.quad, row), column);
    return patch >= 0 && (scene_.patches[patch].triangles.empty() || scene_.patches[patch].cut >= 0);
  }

  Vec3d middle_of(const Edge& edge) const {
    return (grids_[edge.grid].at(edge.from) + grids_[edge.grid].at(edge.to)) * 0.5;
  }

  /// Names the region around a point. `shift`: of the regions, over their size.
  std::uint64_t region(const Vec3d& p, const std::array<double, 3>& shift) const {
    const double size = 4 * tolerance_;
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) key = hash64(key ^ std::uint64_t(std::int64_t(std::floor(p[k] / size + shift[k]))));
    return key;
  }

  void find_neighbours() {
    neighbours_.resize(grids_.size());
    std::unordered_map<std::uint64_t, std::size_t> first;  // edge of each region
    first.reserve(edges_.size());
    for (std::size_t k = 0; k < edges_.size(); ++k) first.try_emplace(edges_[k].key, k);
    for (const Edge& edge : edges_) {
      std::array<std::uint64_t, 8> keys;
      for (int k = 0; k < 8; ++k) {
        const auto shift = [&](int bit) { return k >> bit & 1 ? 0.25 : -0.25; };
        keys[k] = region(middle_of(edge), {shift(0), shift(1), shift(2)});
      }
      std::sort(keys.begin(), keys.end());
      const auto last = std::unique(keys.begin(), keys.end());
      std::vector<const Edge*> found;
      for (auto key = keys.begin(); key != last; ++key)
        if (const auto in_region = first.find(*key); in_region != first.end())
          for (std::size_t k = in_region->second; k < edges_.size() && edges_[k].key == *key; ++k)
            if (&edges_[k] != &edge && continues(edge, edges_[k])) found.push_back(&edges_[k]);
      if (found.size() == 1) neighbours_[edge.grid].push_back({found[0]->grid, &edge, found[0]});
    }
  }

  /// Whether cells on both sides of two edges are parts of one lattice.
  bool continues(const Edge& a, const Edge& b) const {
    const Grid &of_a = grids_[a.grid], &of_b = grids_[b.grid];
    const double error = std::max(tolerance_, kShape * of_a.size());
    const Vec3d from = of_a.at(a.from), to = of_a.at(a.to);
    const bool same = (of_b.at(b.from) - from).length() < error && (of_b.at(b.to) - to).length() < error;
    const bool turned = (of_b.at(b.to) - from).length() < error && (of_b.at(b.from) - to).length() < error;
    if (same == turned || ((of_a.u % of_a.v) ^ (of_b.u % of_b.v)) <= 0) return false;
    const auto across = [](const Grid& grid, const Edge& edge) {
      return grid.u * double(edge.outwards.x) + grid.v * double(edge.outwards.y);
    };
    return (across(of_a, a) + across(of_b, b)).length() < 4 * error;
  }

  /// Adds the lattice of a grid and of all that continue it.
  void add_lattice(std::int32_t first, Lattices& result) const {
    result.frames_[grids_[first].quad].lattice = grids_[first].quad;
    std::vector<std::int32_t> reached{first};
    for (std::size_t k = 0; k < reached.size(); ++k) {
      const Frame frame = result.frames_.at(grids_[reached[k]].quad);
      for (const Neighbour& next : neighbours_[reached[k]]) {
        const auto [at, is_new] = result.frames_.try_emplace(grids_[next.grid].quad);
        if (!is_new) continue;
        at->second = continued(frame, next);
        reached.push_back(next.grid);
      }
    }
    auto& quads = result.quads_.emplace_back();
    for (const std::int32_t g : reached) {
      quads.push_back(grids_[g].quad);
      add_border(grids_[g], result.frames_.at(grids_[g].quad), result);
    }
    std::sort(quads.begin(), quads.end());
  }

  /// The frame of a grid next to one with a frame.
  Frame continued(const Frame& frame, const Neighbour& next) const {
    const Edge &own = *next.own, &other = *next.other;
    const double error = std::max(tolerance_, kShape * grids_[own.grid].size());
    const bool same = (grids_[own.grid].at(own.from) - grids_[next.grid].at(other.from)).length() < error;
    const Node from = frame.node(own.from.x, own.from.y), to = frame.node(own.to.x, own.to.y);
    const Node along = same ? to - from : from - to, inwards = frame.u * own.outwards.x + frame.v * own.outwards.y;
    const bool along_u = other.to.x != other.from.x;
    Frame result;
    result.lattice = frame.lattice;
    result.u = along_u ? along : inwards * -other.outwards.x;
    result.v = along_u ? inwards * -other.outwards.y : along;
    result.origin = (same ? from : to) - result.u * other.from.x - result.v * other.from.y;
    return result;
  }

  static void add_border(const Grid& grid, const Frame& frame, Lattices& result) {
    const auto add = [&](int column, int row) {
      const std::int32_t patch = result.lookup_.at(result.lookup_.row(grid.quad, row), column);
      if (patch < 0) return;
      result.border_.try_emplace({frame.lattice, frame.cell(column, row)},
                                 Cell{patch, frame.edges(result.lookup_.closed_edges(patch))});
    };
    for (int column = 0; column < grid.nu; ++column)
      for (const int row : {0, grid.nv - 1}) add(column, row);
    for (int row = 0; row < grid.nv; ++row)
      for (const int column : {0, grid.nu - 1}) add(column, row);
  }

  const PatchSet& scene_;
  const PatchLookup& lookup_;
  std::vector<Grid> grids_;
  double tolerance_ = 0;                            ///< Of positions, m.
  std::vector<Edge> edges_;                         ///< By their keys.
  std::vector<std::vector<Neighbour>> neighbours_;  ///< [grids]
};

Lattices::Lattices(const PatchSet& scene, const PatchLookup& lookup, const SmoothEdges& smooth) : lookup_(lookup) {
  Builder(scene, lookup, smooth).build(*this);
}

Node Lattices::Frame::cell(std::int64_t column, std::int64_t row) const {
  const Node a = node(column, row), b = node(column + 1, row + 1);
  return {std::min(a.x, b.x), std::min(a.y, b.y)};
}

std::uint8_t Lattices::Frame::edges(std::uint8_t of_grid) const {
  std::uint8_t result = 0;
  for (int k = 0; k < 4; ++k)
    if (of_grid >> k & 1) result |= std::uint8_t(1 << edge_of(u * kOutwards[k].x + v * kOutwards[k].y));
  return result;
}

Lattices::Frame Lattices::frame(std::int32_t i) const {
  const auto found = frames_.find(i);
  return found != frames_.end() ? found->second : Frame{i};
}

const Lattices::Cell* Lattices::find(const Key& key) const {
  const auto found = border_.find(key);
  return found != border_.end() ? &found->second : nullptr;
}

/// Whether nothing stands between two cells that share an edge.
bool Lattices::is_open(std::int32_t lattice, const Node& a, const Node& b) const {
  const Cell *at_a = find({lattice, a}), *at_b = find({lattice, b});
  return at_a && at_b && !(at_a->closed >> edge_of(b - a) & 1) && !(at_b->closed >> edge_of(a - b) & 1);
}

std::int32_t Lattices::beyond(std::int32_t i, int column, int row) const {
  const auto found = frames_.find(i);
  if (found == frames_.end()) return -1;
  const Frame& frame = found->second;
  const int inner_column = std::clamp(column, 0, lookup_.row(i, 0).cells - 1);
  const int inner_row = std::clamp(row, 0, lookup_.rows(i) - 1);
  const Node own = frame.cell(inner_column, inner_row), sought = frame.cell(column, row);
  const Node a = frame.cell(column, inner_row), b = frame.cell(inner_column, row);
  const auto open = [&](const Node& p, const Node& q) { return p == q || is_open(frame.lattice, p, q); };
  if (!open(own, a) || !open(own, b) || !open(a, sought) || !open(b, sought)) return -1;
  return find({frame.lattice, sought})->patch;
}

}  // namespace patchlight

#include "pipeline/optics/cuts/crossings.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "pipeline/optics/cuts/box_tree.h"

namespace patchlight {

namespace {

constexpr double kLow = 0.25;  // height of an edge that stands on a plane, over the size of its surface
constexpr double kPositionRounding = 1.0 / (1 << 22);  // of positions, relative to their coordinates

/// A surface that may cross others or stand on them. Of a region, its pieces may cross, and its edges may stand.
struct Crosser {
  enum class Part { quad, piece, edge };

  Part part;
  std::array<Vec3d, 4> corners;
  std::array<Vec3d, 4> whole;  ///< Of its primitive.
  double size;                 ///< Root of its primitive's area, m.
  double rounding;             ///< Error of its positions, m.
  Imath::Box3d box;            ///< With a margin of `rounding`.

  Crosser(Part of, const Primitive& primitive, const std::array<Vec3d, 4>& of_part)
      : part(of), corners(of_part), whole(primitive.corners) {
    double largest = 0;
    for (const Vec3d& c : corners) {
      box.extendBy(c);
      for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(c[k]));
    }
    rounding = kPositionRounding * largest;
    const double area = 0.5 * ((whole[2] - whole[0]) % (whole[3] - whole[1])).length();
    size = std::sqrt(area * (primitive.region ? primitive.region->area() : 1.0));
    box.min -= Vec3d(rounding);
    box.max += Vec3d(rounding);
  }
};

enum class Where { inside, at_edges };

/// Crossings of one plane primitive.
class Plane {
 public:
  Plane(const Primitive& primitive, const PlaneFrame& frame, Where where)
      : frame_(frame), where_(where), triangle_(primitive.is_triangle()) {
    for (int k = 0; k < 4; ++k) {
      outline_[k] = frame.to_plane(primitive.corners[k]);
      size_ = std::max(size_, outline_[k].length());
    }
    if (!primitive.region) return;
    const auto place = [&](const Vec2d& uv) { return frame.to_plane(position_at(primitive.corners, uv.x, uv.y)); };
    for (const auto& [from, to] : primitive.region->edges) edges_.push_back({place(from), place(to)});
  }

  void add(const Crosser& crosser, double reach) {
    std::array<double, 4> heights;
    for (int k = 0; k < 4; ++k) heights[k] = frame_.height(crosser.corners[k]);
    const double low = *std::min_element(heights.begin(), heights.end());
    const double rounding = crosser.rounding + kPositionRounding * size_;
    relief_ = 0;
    for (const Vec3d& corner : crosser.whole) relief_ = std::max(relief_, frame_.height(corner));
    if (relief_ <= rounding) return;
    if (low < -rounding) {
      if (crosser.part == Crosser::Part::edge) return;
      add_part({0, 1, 2}, crosser, heights);
      add_part({0, 2, 3}, crosser, heights);
    } else if (crosser.part != Crosser::Part::piece) {
      const double highest = std::min(reach, kLow * crosser.size) + rounding;
      for (int k = 0; k < 4; ++k) {
        const int next = (k + 1) % 4;
        const double height = std::max(heights[k], heights[next]);
        if (height <= highest)
          add(crosser.corners[k], crosser.corners[next], rounding, height <= rounding ? 0.0 : height);
      }
    }
  }

  /// Adds the outline of a region.
  void add_outline() {
    for (const auto& [from, to] : edges_) found_.push_back({.from = from, .to = to});
  }

  std::vector<Crossing> crossings() && {
    const auto ends = [](const Crossing& c) { return std::array{c.from.x, c.from.y, c.to.x, c.to.y, c.height}; };
    std::sort(found_.begin(), found_.end(), [&](const auto& a, const auto& b) { return ends(a) < ends(b); });
    std::vector<Crossing> lines;
    for (const Crossing& c : found_) {
      if (!lines.empty() && lines.back().from == c.from && lines.back().to == c.to)
        lines.back().relief = std::max(lines.back().relief, c.relief);
      else
        lines.push_back(c);
    }
    found_ = std::move(lines);
    const std::vector<std::int32_t> group = groups();
    std::vector<Imath::Box2d> boxes(found_.size());
    for (std::size_t i = 0; i < found_.size(); ++i)
      for (const Vec2d& end : {found_[i].from, found_[i].to}) boxes[group[i]].extendBy(end);
    for (std::size_t i = 0; i < found_.size(); ++i) found_[i].extent = boxes[group[i]].size().length();
    return std::move(found_);
  }

 private:
  /// Adds the line in which a triangle of a crosser meets the plane.
  void add_part(const std::array<int, 3>& triangle, const Crosser& crosser, const std::array<double, 4>& heights) {
    std::array<Vec3d, 2> ends;
    int count = 0;
    for (int k = 0; k < 3; ++k) {
      const int a = triangle[k], b = triangle[(k + 1) % 3];
      if ((heights[a] < 0) == (heights[b] < 0) || count == 2) continue;
      const double t = heights[a] / (heights[a] - heights[b]);
      ends[count++] = crosser.corners[a] * (1 - t) + crosser.corners[b] * t;
    }
    if (count == 2) add(ends[0], ends[1], crosser.rounding + kPositionRounding * size_, 0.0);
  }

  /// Adds the part of a line that lies inside of the outline and, or else not, along its edges.
  void add(const Vec3d& from, const Vec3d& to, double rounding, double height) {
    Vec2d a = frame_.to_plane(from), b = frame_.to_plane(to);
    bool at_edge = false;
    for (int k = 0; k < (triangle_ ? 3 : 4); ++k) {
      const Vec2d &p = outline_[k], &q = outline_[triangle_ ? (k + 1) % 3 : (k + 1) % 4];
      const double length = (q - p).length();
      if (length == 0) continue;
      const double inside_a = side_of(p, q, a) / length, inside_b = side_of(p, q, b) / length;
      if (inside_a <= rounding && inside_b <= rounding) {
        if (where_ == Where::inside || std::min(inside_a, inside_b) < -rounding) return;
        at_edge = true;
        continue;
      }
      if (inside_a < 0) a += (b - a) * (inside_a / (inside_a - inside_b));
      if (inside_b < 0) b += (a - b) * (inside_b / (inside_b - inside_a));
    }
    if ((b - a).length() <= 4 * rounding) return;
    at_edge = at_edge || is_at_region_edge(a, b, rounding);
    if (at_edge != (where_ == Where::at_edges)) return;
    if (std::array{b.x, b.y} < std::array{a.x, a.y}) std::swap(a, b);
    found_.push_back({.from = a, .to = b, .height = height, .relief = relief_});
  }

  /// Whether a line lies along one of a region's edges.
  bool is_at_region_edge(const Vec2d& a, const Vec2d& b, double rounding) const {
    return std::any_of(edges_.begin(), edges_.end(), [&](const std::array<Vec2d, 2>& edge) {
      const double length = (edge[1] - edge[0]).length();
      const Vec2d along = (edge[1] - edge[0]) / length;
      const auto is_on_it = [&](const Vec2d& p) {
        const double t = (p - edge[0]) ^ along;
        return std::abs(along.cross(p - edge[0])) <= rounding && t >= -rounding && t <= length + rounding;
      };
      return is_on_it(a) && is_on_it(b);
    });
  }

  /// The group of each crossing: crossings of one group touch each other, directly or through others of it. Named by
  /// the number of one of its crossings.
  std::vector<std::int32_t> groups() const {
    std::vector<std::int32_t> parent(found_.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](std::int32_t i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
    const double cell = 1e-4 * size_;
    std::map<std::array<std::int64_t, 2>, std::int32_t> first;  // of the ends in a cell
    for (std::int32_t i = 0; i < std::int32_t(found_.size()); ++i)
      for (const Vec2d& end : {found_[i].from, found_[i].to}) {
        const auto x = std::int64_t(std::floor(end.x / cell)), y = std::int64_t(std::floor(end.y / cell));
        for (std::int64_t dx = -1; dx <= 1; ++dx)
          for (std::int64_t dy = -1; dy <= 1; ++dy)
            if (const auto at = first.find({x + dx, y + dy}); at != first.end()) parent[root(at->second)] = root(i);
        first.try_emplace({x, y}, i);
      }
    for (std::int32_t i = 0; i < std::int32_t(found_.size()); ++i) parent[i] = root(i);
    return parent;
  }

  const PlaneFrame& frame_;
  const Where where_;
  std::array<Vec2d, 4> outline_;
  std::vector<std::array<Vec2d, 2>> edges_;  ///< Of a region.
  bool triangle_;
  double size_ = 0;
  double relief_ = 0;  ///< Of the surface that is added.
  std::vector<Crossing> found_;
};

std::vector<std::vector<Crossing>> find(const std::vector<Primitive>& primitives,
                                        const std::function<double(std::int32_t)>& reach, Where where) {
  std::vector<Crosser> crossers;
  std::vector<Imath::Box3d> boxes;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const Primitive& p = primitives[i];
    const bool is_back = p.back >= 0 && p.back < std::int32_t(i);  // in the same place as its front
    if (p.shape != Primitive::Shape::quad || p.mask >= 0 || p.intangible || is_back) continue;
    if (!p.region) {
      crossers.emplace_back(Crosser::Part::quad, p, p.corners);
      continue;
    }
    const auto place = [&](const Vec2d& uv) { return position_at(p.corners, uv.x, uv.y); };
    for (const auto& [a, b, c, d] : p.region->pieces)
      crossers.emplace_back(Crosser::Part::piece, p, std::array{place(a), place(b), place(c), place(d)});
    for (const auto& [from, to] : p.region->edges)
      crossers.emplace_back(Crosser::Part::edge, p, std::array{place(from), place(to), place(to), place(to)});
  }
  for (const Crosser& crosser : crossers) boxes.push_back(crosser.box);
  const BoxTree tree(boxes);
  std::vector<std::vector<Crossing>> result(primitives.size());
  tbb::parallel_for(std::size_t(0), primitives.size(), [&](std::size_t i) {
    const double height = reach(std::int32_t(i));
    const std::optional<PlaneFrame> frame = height < 0 ? std::nullopt : PlaneFrame::of(primitives[i]);
    if (!frame) return;
    Imath::Box3d box;
    for (const Vec3d& corner : primitives[i].corners) {
      box.extendBy(corner);
      box.extendBy(corner + frame->normal() * height);
    }
    Plane plane(primitives[i], *frame, where);
    for (const std::int32_t k : tree.overlapping(box)) plane.add(crossers[k], height);
    result[i] = std::move(plane).crossings();
  });
  return result;
}

}  // namespace

std::vector<std::vector<Crossing>> find_crossings(const std::vector<Primitive>& primitives,
                                                  const std::function<double(std::int32_t)>& reach) {
  return find(primitives, reach, Where::inside);
}

std::vector<std::vector<Crossing>> find_crossings_at_edges(const std::vector<Primitive>& primitives,
                                                           const std::function<double(std::int32_t)>& reach) {
  return find(primitives, reach, Where::at_edges);
}

std::vector<std::vector<Crossing>> outlines_of_regions(const std::vector<Primitive>& primitives) {
  std::vector<std::vector<Crossing>> result(primitives.size());
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    if (!primitives[i].region) continue;
    const PlaneFrame frame = *PlaneFrame::of(primitives[i]);
    Plane plane(primitives[i], frame, Where::at_edges);
    plane.add_outline();
    result[i] = std::move(plane).crossings();
    for (Crossing& edge : result[i]) edge.extent = (edge.to - edge.from).length();
  }
  return result;
}

}  // namespace patchlight

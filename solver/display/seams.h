#pragma once
#include <unordered_map>
#include <vector>

#include "pipeline/optics/cuts/crossings.h"
#include "pipeline/optics/surface/lattices.h"

namespace patchlight {

/// Where plane surfaces go on in other quads whose cells do not continue theirs (Lattices): pieces of a large surface
/// with cells of different sizes, or modelled pieces of a ceiling.
class Seams {
 public:
  /// `reach`: as in find_crossings(), negative for primitives without seams. `at_edges`: what stands at the outlines;
  /// must outlive this object. Shape of both: [primitives].
  Seams(const PatchSet& scene, const Lattices& lattices, const std::vector<double>& reach,
        const std::vector<std::vector<Crossing>>& at_edges);

  /// Whether a quad shares the vertices on its outline with others.
  bool has(std::int32_t i) const { return has_[i]; }
  /// Whether a cell touches a seam.
  bool touches(const Patch& cell) const;
  /// Whether nothing stands at a point on the outline of quad `i`; a position in its PlaneFrame.
  bool is_open(std::int32_t i, const Vec2d& point) const;
  /// Largest error of positions on quads that have seams, m.
  double rounding() const { return rounding_; }

 private:
  struct Line {
    Vec2d from, to;
  };

  const PatchSet& scene_;
  std::vector<bool> has_;                 ///< [primitives]
  std::vector<std::vector<Line>> lines_;  ///< [primitives] In PlaneFrames.
  const std::vector<std::vector<Crossing>>& at_edges_;
  double rounding_ = 0;
};

/// Numbers points on surfaces: equal numbers for the same point on quads of one plane.
class SharedPoints {
 public:
  /// `rounding`: largest error of positions, m.
  explicit SharedPoints(double rounding) : rounding_(rounding) {}

  /// The number of the nearest point within `tolerance` <= rounding, m, on a surface that faces `normal`; a new one if
  /// there is none.
  std::int32_t number(const Vec3d& point, const Vec3d& normal, double tolerance);

 private:
  struct Point {
    Vec3d at, normal;
  };

  double rounding_;
  std::vector<Point> points_;
  std::unordered_multimap<std::uint64_t, std::int32_t> by_region_;
};

}  // namespace patchlight

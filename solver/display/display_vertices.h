#pragma once
#include <limits>
#include <unordered_map>
#include <vector>

#include "pipeline/optics/surface/smooth_edges.h"
#include "solver/display/leaf_lattice.h"
#include "solver/display/sectors.h"

namespace patchlight {

/// What lies around a vertex on a plane with crossings.
struct Surroundings {
  Sectors sectors{};
  int sector = 0;                                         ///< That of the vertex.
  double room = std::numeric_limits<double>::infinity();  ///< Distance to the far edges of its faces, m.
};

/// Builds the vertices of a DisplayMesh whose cells are given.
class DisplayVertices {
 public:
  /// `is_open` [patches]: where vertices gather light.
  DisplayVertices(const PatchSet& scene, const PatchLookup& lookup, const Lattices& lattices, const SmoothEdges& smooth,
                  const std::vector<bool>& is_open, DisplayMesh& mesh)
      : scene_(scene), lookup_(lookup), lattices_(lattices), smooth_(smooth), is_open_(is_open), mesh_(mesh) {}

  /// The number of a vertex at a corner of a face of `leaf`, on `patch`.
  std::int32_t at(const VertexKey& key, const Leaf& leaf, std::int32_t patch, const Vec2f& uv,
                  const Surroundings& around = {});

  /// Moves vertices off the edges of their faces, where surfaces may meet; into their sectors if they have some.
  void move_off_edges();

  /// Finds vertices of smaller leaves in the middle of the edge from a to b of a leaf that is not cut, whose corners
  /// are the vertices `at_a` and `at_b`. key_of(node, size) is the key of the leaf's vertex at a node from
  /// which others are half of `size` away, in finest cells.
  template <class KeyOf>
  void find_midpoints(const Leaf::Node& a, const Leaf::Node& b, std::int32_t at_a, std::int32_t at_b,
                      const KeyOf& key_of) {
    const auto size = int(std::abs(b.x - a.x) + std::abs(b.y - a.y));
    if (size < 2) return;
    const Leaf::Node middle{(a.x + b.x) / 2, (a.y + b.y) / 2};
    const auto found = numbers_.find(key_of(middle, size));
    if (found == numbers_.end()) return;
    const std::int32_t k = found->second;
    if (k == at_a || k == at_b) return;  // at the tip of a triangle all nodes are one point
    if (places_[k].kind == Kind::gathered && !places_[k].is_end) {
      places_[k].kind = Kind::midpoint;
      places_[at_a].is_end = places_[at_b].is_end = true;
      midpoints_.push_back({k, at_a, at_b});
    }
    find_midpoints(a, middle, at_a, k, key_of);
    find_midpoints(middle, b, k, at_b, key_of);
  }

  /// Sorts the mesh's vertices by their kinds.
  void sort();

 private:
  enum class Kind { gathered, border, hidden, midpoint };
  struct Place {
    Kind kind;
    Vec2f step;            ///< Size of a finest cell in (u,v).
    float size;            ///< Of the smallest leaf around, in finest cells; 0 on a cut.
    std::uint64_t random;  ///< Of the key.
    Surroundings around;
    bool is_end = false;  ///< A midpoint depends on it, so it is none: cells on both sides of a seam may overlap.
  };

  bool is_border(std::int32_t i, const Vec2f& at, const Vec2f& reach, const Surroundings& around) const;

  const PatchSet& scene_;
  const PatchLookup& lookup_;
  const Lattices& lattices_;
  const SmoothEdges& smooth_;
  const std::vector<bool>& is_open_;
  DisplayMesh& mesh_;
  std::unordered_map<VertexKey, std::int32_t, VertexKeyHash> numbers_;
  std::vector<Place> places_;                           ///< [vertices]
  std::vector<std::array<std::int32_t, 3>> midpoints_;  ///< A vertex and the two vertices it lies between.
};

}  // namespace patchlight

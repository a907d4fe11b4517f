#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// What a LightTree needs to know of an emitter.
struct LightBounds {
  Vec3d center{0.0};
  double radius = 0.0;        ///< Of a sphere around the emitter, m.
  Vec3d axis{0.0, 0.0, 1.0};  ///< Of the cone of its normals, unit vector.
  double angle = 0.0;         ///< Half angle of the cone, rad; pi: a sphere.
  double area = 0.0;          ///< Largest projected area, m2.
};

/// A binary tree over emitters for importance sampling (Conty Estevez and Kulla 2018). Importance depends on geometry
/// alone: area, distance, and the bounds of both cosines; so samples serve for any strength of the emitters. It is
/// positive wherever an emitter can light the receiver.
class LightTree {
 public:
  explicit LightTree(std::span<const LightBounds> emitters);

  /// A surface to be lit: a sphere around it, and its normal.
  struct Receiver {
    Vec3d center{0.0};
    double radius = 0.0;  ///< m
    Vec3d normal{0.0};    ///< Unit vector; zero: in all directions.
  };

  /// An emitter and the probability of its choice.
  struct Choice {
    std::int32_t emitter = 0;
    double probability = 0.0;
  };

  class Cut;

 private:
  /// LightBounds with the sine and the cosine of the cone's half angle.
  struct Bounds : LightBounds {
    double cosine = 1.0, sine = 0.0;

    Bounds() = default;
    explicit Bounds(const LightBounds& bounds);
  };
  struct Node {
    Bounds bounds;
    std::int32_t first = 0;  ///< First of two children; of a leaf: first of its emitters.
    std::int32_t count = 0;  ///< Of a leaf's emitters; 0: not a leaf.
  };
  struct Part {  ///< A node of a cut through the tree.
    std::int32_t node = 0;
    double importance = 0.0, spread = 0.0;
  };

  static std::pair<double, double> importance(const Bounds& light, const Receiver& receiver);
  void build(std::int32_t node, std::int32_t begin, std::int32_t end);

  std::vector<Node> nodes_;
  std::vector<Bounds> emitters_;     ///< In the order of the leaves.
  std::vector<std::int32_t> index_;  ///< Of these emitters.
};

/// The nodes of a LightTree from which the emitters of one receiver are chosen: near and important ones are divided.
/// The tree must outlive it.
class LightTree::Cut {
 public:
  Cut(const LightTree& tree, const Receiver& receiver);

  /// `count` choices, stratified: choice k by the point (k + shift) / count of the unit interval, which maps to the
  /// emitters in the order of the tree. Empty if no emitter can light the receiver.
  std::vector<Choice> choose(int count, double shift);

  /// How much the receiver's size blurs importance: its radius over the distance of the emitters, at most 1, the mean
  /// by importance.
  double blur() const;

 private:
  void divide();
  Choice descend(std::int32_t node, double at, double probability);
  Choice choose_in_leaf(std::int32_t node, double at, double probability);

  const LightTree& tree_;
  const Receiver receiver_;
  std::vector<Part> parts_;   ///< In the order of the tree.
  std::int32_t leaf_ = -1;    ///< The last leaf,
  std::vector<double> sums_;  ///< and the importance of its emitters up to each.
};

}  // namespace patchlight

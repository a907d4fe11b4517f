#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// What a LightTree needs to know of an emitter.
struct LightBounds {
  Vec3d center{0.0};
  double radius = 0.0;        ///< Of a sphere around the emitter, m.
  Vec3d axis{0.0, 0.0, 1.0};  ///< Of the cone of its normals, unit vector.
  double angle = 0.0;         ///< Half angle of the cone, rad; pi: a sphere.
  double area = 0.0;          ///< Of the surface, m2.
};

/// A tree over emitters for importance sampling (Conty Estevez and Kulla 2018), with eight children a node. Importance
/// depends on area, distance and bounds of both cosines. It is positive wherever an emitter can light the receiver.
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

  /// Importance of all emitters together.
  double importance(const Receiver& receiver) const;
  /// The choice by a point of the unit interval; a Cut stratifies many choices.
  Choice choose(const Receiver& receiver, double at) const;
  /// Probability of an emitter for choose().
  double probability(std::int32_t emitter, const Receiver& receiver) const;

 private:
  static constexpr int kWidth = 8;
  using Floats = float __attribute__((vector_size(4 * kWidth)));

  /// The bounds of up to eight children, around the tree's origin.
  struct alignas(32) Node {
    Floats x{}, y{}, z{}, radius{};
    Floats axis_x{}, axis_y{}, axis_z{}, cosine{}, sine{};  ///< Of the cone of normals, and of its half angle.
    Floats area{};                                          ///< 0: no child.
    std::array<std::int32_t, kWidth> child{};               ///< A node, or ~i: emitter i.
  };
  /// What a receiver makes of a node's children.
  struct alignas(32) Weights {
    Floats importance;
    Floats spread;  ///< Radius of child and receiver together over their distance.
    Floats blur;    ///< Radius of the receiver over that distance.

    float sum() const;
    /// The child at a point of the unit interval; the point becomes that within the child, and its part multiplies
    /// `probability`. -1: none has importance.
    int choose(double& at, double& probability) const;
  };
  /// A part of a cut through the tree.
  struct Part {
    std::int32_t child = 0;
    float importance = 0.0f, spread = 0.0f, blur = 0.0f;
  };

  /// A child of a node.
  struct Place {
    std::int32_t node = -1, lane = 0;
  };

  LightBounds build(std::span<const LightBounds> emitters, std::span<std::int32_t> some, std::int32_t node);
  std::vector<Part> parts(std::int32_t node, const Receiver& receiver) const;
  Weights weights(std::int32_t node, const Receiver& receiver) const;
  Weights weights_by_bounds(const Node& node, const Receiver& receiver) const;
  /// Whether the children of a node are emitters.
  bool is_leaf(std::int32_t node) const { return node >= 0 && nodes_[node].child[0] < 0; }

  Vec3d origin_{0.0};
  std::vector<Node> nodes_;
  std::vector<Place> node_places_, emitter_places_;
};

/// The parts of a LightTree from which the emitters of one receiver are chosen: near and important ones are divided.
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
  Choice descend(const Part& part, double at, double probability);

  const LightTree& tree_;
  const Receiver receiver_;
  std::vector<Part> parts_;  ///< In the order of the tree.
  struct Level {
    std::int32_t node = -1;
    Weights weights;
  };
  std::vector<Level> path_;  ///< The last way down the tree.
};

}  // namespace patchlight

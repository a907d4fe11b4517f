#include "pipeline/optics/lights/light_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace patchlight {

namespace {

constexpr std::size_t kMaxParts = 64;  // of a cut
constexpr float kMinSpread = 0.1f;     // of a node, below which it is not divided for a cut
constexpr float kLeastSpread = 1e-4f;  // covers the rounding of directions

double angle_between(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::clamp(a ^ b, -1.0, 1.0));
}

/// A cone around two cones of directions.
void merge_cones(const LightBounds& a, const LightBounds& b, LightBounds& both) {
  const LightBounds &wide = a.angle >= b.angle ? a : b, &other = a.angle >= b.angle ? b : a;
  const double between = angle_between(wide.axis, other.axis);
  both.axis = wide.axis;
  both.angle = wide.angle;
  if (between + other.angle <= wide.angle) return;
  both.angle = 0.5 * (wide.angle + between + other.angle);
  const Vec3d around = wide.axis % other.axis;
  if (both.angle >= kPi || around.length2() < 1e-20) {
    both.angle = kPi;
    return;
  }
  const double turn = both.angle - wide.angle;
  const Vec3d side = (around.normalized() % wide.axis).normalized();
  both.axis = (wide.axis * std::cos(turn) + side * std::sin(turn)).normalized();
}

LightBounds merged(const LightBounds& a, const LightBounds& b) {
  LightBounds both;
  const Vec3d to = b.center - a.center;
  const double distance = to.length();
  if (distance + b.radius <= a.radius) {
    both.center = a.center, both.radius = a.radius;
  } else if (distance + a.radius <= b.radius) {
    both.center = b.center, both.radius = b.radius;
  } else {
    both.radius = 0.5 * (distance + a.radius + b.radius);
    both.center = a.center + to * ((both.radius - a.radius) / distance);
  }
  both.area = a.area + b.area;
  merge_cones(a, b, both);
  return both;
}

/// Two parts of some emitters, the first with `count` of them, which it sorts along their longest extent.
std::pair<std::span<std::int32_t>, std::span<std::int32_t>> split(std::span<const LightBounds> emitters,
                                                                  std::span<std::int32_t> some, std::size_t count) {
  Vec3d low = emitters[some[0]].center, high = low;
  for (const std::int32_t i : some)
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], emitters[i].center[axis]);
      high[axis] = std::max(high[axis], emitters[i].center[axis]);
    }
  const Vec3d size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto key = [&](std::int32_t i) { return std::pair(emitters[i].center[axis], i); };
  std::ranges::nth_element(some, some.begin() + std::ptrdiff_t(count), {}, key);
  return {some.first(count), some.subspan(count)};
}

/// Divides some emitters into `count` parts.
void divide(std::span<const LightBounds> emitters, std::span<std::int32_t> some, std::size_t count,
            std::vector<std::span<std::int32_t>>& parts) {
  if (count == 1) {
    parts.push_back(some);
    return;
  }
  const auto [first, second] = split(emitters, some, some.size() * (count / 2) / count);
  divide(emitters, first, count / 2, parts);
  divide(emitters, second, count - count / 2, parts);
}

// Operations on all children of a node at once.

template <class Floats>
Floats square_root(const Floats& x) {
  Floats root;
  for (std::size_t k = 0; k < sizeof x / sizeof x[0]; ++k) root[k] = std::sqrt(x[k]);
  return root;
}

template <class Floats>
Floats larger(const Floats& a, const Floats& b) {
  return a > b ? a : b;
}

/// cos(max(0, a - b)), at least 0, from the cosine of a and the cosine and sine of b; all angles in [0,pi].
template <class Floats>
Floats bounded_cosine(const Floats& cos_a, const Floats& cos_b, const Floats& sin_b) {
  const Floats zero{}, sin_a = square_root(larger(1 - cos_a * cos_a, zero));
  return cos_a >= cos_b ? zero + 1 : larger(cos_a * cos_b + sin_a * sin_b, zero);
}

}  // namespace

LightTree::LightTree(std::span<const LightBounds> emitters) {
  if (emitters.empty()) return;
  for (const LightBounds& emitter : emitters) origin_ += emitter.center / double(emitters.size());
  std::vector<std::int32_t> all(emitters.size());
  std::iota(all.begin(), all.end(), 0);
  nodes_.resize(1);
  node_places_.resize(1);
  emitter_places_.resize(emitters.size());
  build(emitters, all, 0);
}

/// Builds the nodes of some emitters, which it sorts, from `node` on. Returns their bounds.
LightBounds LightTree::build(std::span<const LightBounds> emitters, std::span<std::int32_t> some, std::int32_t node) {
  std::size_t capacity = 1;  // emitters of a full child
  while (capacity * kWidth < some.size()) capacity *= kWidth;
  std::vector<std::span<std::int32_t>> children;
  divide(emitters, some, (some.size() + capacity - 1) / capacity, children);
  LightBounds all;
  for (std::size_t k = 0; k < children.size(); ++k) {
    std::int32_t child = ~children[k][0];
    LightBounds bounds = emitters[children[k][0]];
    if (capacity > 1) {
      child = std::int32_t(nodes_.size());
      nodes_.emplace_back();
      node_places_.push_back({node, std::int32_t(k)});
      bounds = build(emitters, children[k], child);
    }
    all = k == 0 ? bounds : merged(all, bounds);
    if (child < 0) emitter_places_[~child] = {node, std::int32_t(k)};
    Node& n = nodes_[node];
    const Vec3f center(bounds.center - origin_), axis(bounds.axis);
    n.x[k] = center.x, n.y[k] = center.y, n.z[k] = center.z;
    n.axis_x[k] = axis.x, n.axis_y[k] = axis.y, n.axis_z[k] = axis.z;
    n.radius[k] = float(bounds.radius), n.child[k] = child;
    n.area[k] = float(bounds.area * (1 - 0.75 * bounds.angle / kPi));  // about the mean projection
    n.cosine[k] = float(std::cos(bounds.angle)), n.sine[k] = bounds.angle < kPi ? float(std::sin(bounds.angle)) : 0.0f;
  }
  return all;
}

float LightTree::Weights::sum() const {
  float sum = 0;
  for (int k = 0; k < kWidth; ++k) sum += importance[k];
  return sum;
}

/// Weights of a node's children. A child that is a node of emitters has the importance of these emitters together: the
/// bounds of facets that face all ways say little about them.
LightTree::Weights LightTree::weights(std::int32_t node, const Receiver& receiver) const {
  Weights result = weights_by_bounds(nodes_[node], receiver);
  for (int k = 0; k < kWidth; ++k)
    if (const std::int32_t child = nodes_[node].child[k]; result.importance[k] > 0 && is_leaf(child))
      result.importance[k] = weights_by_bounds(nodes_[child], receiver).sum();
  return result;
}

LightTree::Weights LightTree::weights_by_bounds(const Node& n, const Receiver& receiver) const {
  const Vec3f at(receiver.center - origin_), normal(receiver.normal);
  const auto size = float(receiver.radius);
  const Floats zero{}, one = zero + 1;
  const Floats x = at.x - n.x, y = at.y - n.y, z = at.z - n.z;
  const Floats radius = n.radius + size, squared = x * x + y * y + z * z;
  const auto inside = squared <= radius * radius;
  const Floats inverse = 1 / square_root(larger(inside ? radius * radius : squared, zero + 1e-30f));
  const Floats wide = larger(radius * inverse, zero + kLeastSpread), spread = wide > 1 ? one : wide;
  const Floats close = square_root(1 - spread * spread);  // cosine of the angle that the spheres blur directions by
  const Floats cosine = n.cosine * close - n.sine * spread, sine = n.sine * close + n.cosine * spread;
  const Floats leaves = (n.axis_x * x + n.axis_y * y + n.axis_z * z) * inverse;
  const Floats arrives = -(normal.x * x + normal.y * y + normal.z * z) * inverse;
  const Floats emitted = (inside | (sine <= 0)) ? one : bounded_cosine(leaves, cosine, sine);
  const Floats received = receiver.normal == Vec3d(0.0) ? one : bounded_cosine(arrives, close, spread);
  return {n.area * inverse * inverse * emitted * (inside ? one : received), spread, inside ? one : size * inverse};
}

int LightTree::Weights::choose(double& at, double& probability) const {
  const auto all = double(sum());
  if (!(all > 0)) return -1;
  double rest = at * all;
  int k = 0;
  while (k + 1 < kWidth && rest >= double(importance[k])) rest -= double(importance[k++]);
  while (importance[k] <= 0) --k;  // beyond the last by rounding
  at = std::clamp(rest / double(importance[k]), 0.0, 1.0 - 1e-9);
  probability *= double(importance[k]) / all;
  return k;
}

double LightTree::importance(const Receiver& receiver) const {
  return nodes_.empty() ? 0.0 : double(weights(0, receiver).sum());
}

LightTree::Choice LightTree::choose(const Receiver& receiver, double at) const {
  Choice choice{0, 1.0};
  while (choice.emitter >= 0) {
    const int k = weights(choice.emitter, receiver).choose(at, choice.probability);
    if (k < 0) return {};
    choice.emitter = nodes_[choice.emitter].child[k];
  }
  return {~choice.emitter, choice.probability};
}

double LightTree::probability(std::int32_t emitter, const Receiver& receiver) const {
  double probability = 1;
  for (Place at = emitter_places_[emitter]; at.node >= 0; at = node_places_[at.node]) {
    const Weights w = weights(at.node, receiver);
    const auto all = double(w.sum());
    if (!(all > 0)) return 0;
    probability *= double(w.importance[at.lane]) / all;
  }
  return probability;
}

/// The children of a node, as parts of a cut. A child that is an emitter, or a node whose children are all emitters, is
/// never divided: its spread is 0.
std::vector<LightTree::Part> LightTree::parts(std::int32_t node, const Receiver& receiver) const {
  const Weights w = weights(node, receiver);
  std::vector<Part> parts;
  for (int k = 0; k < kWidth; ++k) {
    if (w.importance[k] <= 0) continue;
    Part part{nodes_[node].child[k], w.importance[k], w.spread[k], w.blur[k]};
    if (part.child < 0 || is_leaf(part.child)) part.spread = 0;
    parts.push_back(part);
  }
  return parts;
}

LightTree::Cut::Cut(const LightTree& tree, const Receiver& receiver) : tree_(tree), receiver_(receiver) {
  if (tree.nodes_.empty()) return;
  parts_.reserve(kMaxParts);
  parts_.push_back({0, 1.0f, 1.0f, 1.0f});
  std::size_t urgent = 0;
  do {
    const std::vector<Part> children = tree.parts(parts_[urgent].child, receiver);
    const auto at = parts_.erase(parts_.begin() + std::ptrdiff_t(urgent));
    parts_.insert(at, children.begin(), children.end());
    float most = 0;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      const float urgency = parts_[k].spread < kMinSpread ? 0.0f : parts_[k].importance * parts_[k].spread;
      if (urgency > most) most = urgency, urgent = k;
    }
    if (most == 0) break;
  } while (parts_.size() + kWidth <= kMaxParts);
}

LightTree::Choice LightTree::Cut::descend(const Part& part, double at, double probability) {
  std::int32_t child = part.child;
  for (std::size_t depth = 0; child >= 0; ++depth) {
    if (depth == path_.size()) path_.emplace_back();
    auto& [node, weights] = path_[depth];
    if (node != child) {
      node = child;
      weights = tree_.weights(child, receiver_);
    }
    const int k = weights.choose(at, probability);
    if (k < 0) return {};
    child = tree_.nodes_[child].child[k];
  }
  return {~child, probability};
}

double LightTree::Cut::blur() const {
  double sum = 0, total = 0;
  for (const Part& part : parts_) {
    sum += double(part.importance * part.blur);
    total += double(part.importance);
  }
  return total > 0 ? sum / total : 0.0;
}

std::vector<LightTree::Choice> LightTree::Cut::choose(int count, double shift) {
  std::vector<Choice> choices;
  double total = 0;
  for (const Part& part : parts_) total += double(part.importance);
  if (total <= 0) return choices;
  choices.reserve(std::size_t(count));
  std::size_t p = 0;
  double below = 0;
  for (int k = 0; k < count; ++k) {
    const double at = (double(k) + shift) / count * total;
    while (p + 1 < parts_.size() && at >= below + double(parts_[p].importance)) below += double(parts_[p++].importance);
    const auto own = double(parts_[p].importance);
    choices.push_back(descend(parts_[p], std::clamp((at - below) / own, 0.0, 1.0 - 1e-9), own / total));
  }
  return choices;
}

}  // namespace patchlight

#include "pipeline/optics/lights/light_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace patchlight {

namespace {

constexpr std::int32_t kMaxLeaf = 8;  // emitters of a leaf
constexpr int kMaxParts = 64;         // of a cut
constexpr double kMinSpread = 0.1;    // radius over distance of a node below which it is not divided for a cut

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

/// cos(max(0, a - b)), at least 0, from the cosine of a and the cosine and sine of b; all angles in [0,pi].
double bounded_cosine(double cos_a, double cos_b, double sin_b) {
  if (cos_a >= cos_b) return 1.0;
  return std::max(0.0, cos_a * cos_b + std::sqrt(std::max(0.0, 1 - cos_a * cos_a)) * sin_b);
}

}  // namespace

LightTree::Bounds::Bounds(const LightBounds& bounds)
    : LightBounds(bounds), cosine(std::cos(bounds.angle)), sine(std::sin(bounds.angle)) {}

LightTree::LightTree(std::span<const LightBounds> emitters) : emitters_(emitters.begin(), emitters.end()) {
  if (emitters.empty()) return;
  index_.resize(emitters.size());
  std::iota(index_.begin(), index_.end(), 0);
  nodes_.resize(1);
  build(0, 0, std::int32_t(emitters.size()));
  for (std::size_t k = 0; k < index_.size(); ++k) emitters_[k] = Bounds(emitters[index_[k]]);
}

void LightTree::build(std::int32_t node, std::int32_t begin, std::int32_t end) {
  if (end - begin <= kMaxLeaf) {
    LightBounds bounds = emitters_[index_[begin]];
    for (std::int32_t k = begin + 1; k < end; ++k) bounds = merged(bounds, emitters_[index_[k]]);
    nodes_[node] = {Bounds(bounds), begin, end - begin};
    return;
  }
  Vec3d low = emitters_[index_[begin]].center, high = low;
  for (std::int32_t k = begin; k < end; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], emitters_[index_[k]].center[axis]);
      high[axis] = std::max(high[axis], emitters_[index_[k]].center[axis]);
    }
  const Vec3d size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::int32_t middle = (begin + end) / 2;
  const auto key = [&](std::int32_t i) { return std::pair(emitters_[i].center[axis], i); };
  std::nth_element(index_.begin() + begin, index_.begin() + middle, index_.begin() + end,
                   [&](std::int32_t a, std::int32_t b) { return key(a) < key(b); });
  const auto child = std::int32_t(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  build(child, begin, middle);
  build(child + 1, middle, end);
  nodes_[node] = {Bounds(merged(nodes_[child].bounds, nodes_[child + 1].bounds)), child, 0};
}

/// Importance of emitters for a receiver, and the radius over distance of both together.
std::pair<double, double> LightTree::importance(const Bounds& light, const Receiver& receiver) {
  const Vec3d from = receiver.center - light.center;
  const double radius = light.radius + receiver.radius, squared = from.length2();
  if (squared <= radius * radius) return {light.area / (radius * radius), 1.0};
  const double inverse = 1 / std::sqrt(squared), spread = radius * inverse;
  const double close = std::sqrt(1 - spread * spread);  // cosine of the angle that the spheres blur directions by
  double result = light.area * inverse * inverse;
  if (light.angle < kPi) {
    const double cosine = light.cosine * close - light.sine * spread;
    const double sine = light.sine * close + light.cosine * spread;
    if (sine > 0) result *= bounded_cosine((light.axis ^ from) * inverse, cosine, sine);
  }
  if (receiver.normal != Vec3d(0.0)) result *= bounded_cosine(-(receiver.normal ^ from) * inverse, close, spread);
  return {result, spread};
}

LightTree::Cut::Cut(const LightTree& tree, const Receiver& receiver) : tree_(tree), receiver_(receiver) {
  if (!tree.nodes_.empty()) divide();
}

/// Divides nodes until there are kMaxParts.
void LightTree::Cut::divide() {
  const auto part = [&](std::int32_t node) {
    const auto [bounds, first, count] = tree_.nodes_[node];
    const auto [value, spread] = importance(bounds, receiver_);
    if (count == 0) return Part{node, value, spread};
    Part leaf{node, 0.0, 0.0};
    for (std::int32_t k = first; k < first + count && value > 0; ++k)
      leaf.importance += importance(tree_.emitters_[k], receiver_).first;
    return leaf;
  };
  const auto less_urgent = [](const Part& a, const Part& b) {
    return a.importance * a.spread < b.importance * b.spread;
  };
  std::vector<Part> parts{part(0)};
  while (!parts.empty() && parts.size() + parts_.size() < kMaxParts) {
    std::pop_heap(parts.begin(), parts.end(), less_urgent);
    const Part top = parts.back();
    parts.pop_back();
    if (top.spread < kMinSpread) {
      parts_.push_back(top);
      continue;
    }
    for (int k = 0; k < 2; ++k)
      if (const Part child = part(tree_.nodes_[top.node].first + k); child.importance > 0) {
        parts.push_back(child);
        std::push_heap(parts.begin(), parts.end(), less_urgent);
      }
  }
  parts_.insert(parts_.end(), parts.begin(), parts.end());
  std::erase_if(parts_, [](const Part& p) { return p.importance <= 0; });
  std::sort(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) { return a.node < b.node; });
}

LightTree::Choice LightTree::Cut::descend(std::int32_t node, double at, double probability) {
  const std::vector<Node>& nodes = tree_.nodes_;
  while (nodes[node].count == 0) {
    const std::int32_t child = nodes[node].first;
    const double left = importance(nodes[child].bounds, receiver_).first;
    const double right = importance(nodes[child + 1].bounds, receiver_).first;
    if (left + right <= 0) return {};
    const double part = left / (left + right);
    const bool goes_left = at < part;
    at = goes_left ? at / part : (at - part) / (1 - part);
    probability *= goes_left ? part : 1 - part;
    node = goes_left ? child : child + 1;
  }
  return choose_in_leaf(node, at, probability);
}

LightTree::Choice LightTree::Cut::choose_in_leaf(std::int32_t node, double at, double probability) {
  const std::int32_t first = tree_.nodes_[node].first, count = tree_.nodes_[node].count;
  if (leaf_ != node) {
    sums_.assign(std::size_t(count), 0.0);
    double sum = 0;
    for (std::int32_t k = 0; k < count; ++k) sums_[k] = sum += importance(tree_.emitters_[first + k], receiver_).first;
    leaf_ = node;
  }
  const double sum = sums_.back();
  if (sum <= 0) return {};
  const auto k = std::min(std::upper_bound(sums_.begin(), sums_.end(), at * sum), sums_.end() - 1) - sums_.begin();
  const double own = sums_[k] - (k > 0 ? sums_[k - 1] : 0.0);
  return {tree_.index_[first + k], probability * own / sum};
}

double LightTree::Cut::blur() const {
  double sum = 0, total = 0;
  for (const Part& part : parts_) {
    const Bounds& light = tree_.nodes_[part.node].bounds;
    const double distance = (receiver_.center - light.center).length() - light.radius;
    sum += part.importance * (distance > receiver_.radius ? receiver_.radius / distance : 1.0);
    total += part.importance;
  }
  return total > 0 ? sum / total : 0.0;
}

std::vector<LightTree::Choice> LightTree::Cut::choose(int count, double shift) {
  std::vector<Choice> choices;
  double total = 0;
  for (const Part& part : parts_) total += part.importance;
  if (total <= 0) return choices;
  std::size_t p = 0;
  double below = 0;
  for (int k = 0; k < count; ++k) {
    const double at = (double(k) + shift) / count * total;
    while (p + 1 < parts_.size() && at >= below + parts_[p].importance) below += parts_[p++].importance;
    const double inside = std::clamp((at - below) / parts_[p].importance, 0.0, 1.0 - 1e-9);
    choices.push_back(descend(parts_[p].node, inside, parts_[p].importance / total));
  }
  return choices;
}

}  // namespace patchlight

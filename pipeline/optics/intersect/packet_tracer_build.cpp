#include <ImathBox.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "pipeline/optics/intersect/packet_tracer.h"
#include "pipeline/optics/intersect/quad_shape.h"

namespace patchlight {

namespace {

constexpr float kBox = 1.0f;  // cost of a box over that of a surface, measured

using packet::PrimitiveReference;

void copy_to(float (&to)[3], const Vec3d& from) {
  for (int k = 0; k < 3; ++k) to[k] = float(from[k]);
}

float half_area(const Imath::Box3f& box) {
  const Vec3f size = box.size();
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

/// Makes a tree by the surface area heuristic (MacDonald and Booth 1990), exactly: every place between two items, along
/// every axis. Items are sorted once along each and stay so, whatever node they go to.
class TreeBuilder {
 public:
  TreeBuilder(const std::vector<Imath::Box3f>& boxes, std::vector<PrimitiveReference>& items,
              std::vector<packet::Node>& nodes)
      : boxes_(boxes),
        items_(items),
        nodes_(nodes),
        above_(items.size()),
        goes_left_(items.size()),
        right_(items.size()) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto key = [&](std::int32_t k) {
        return std::pair(boxes[k].min[axis] + boxes[k].max[axis], items[k].surface);
      };
      orders_[axis].resize(items.size());
      std::iota(orders_[axis].begin(), orders_[axis].end(), 0);
      std::sort(orders_[axis].begin(), orders_[axis].end(),
                [&](std::int32_t a, std::int32_t b) { return key(a) < key(b); });
    }
  }

  /// Sets the nodes, and puts the items in the order of their leaves.
  void build() {
    nodes_.resize(1);
    split(0, 0, std::int32_t(items_.size()), 0);
    std::vector<PrimitiveReference> sorted;
    sorted.reserve(items_.size());
    for (const std::int32_t k : orders_[0]) sorted.push_back(items_[k]);
    items_ = std::move(sorted);
  }

 private:
  void split(std::int32_t at, std::int32_t begin, std::int32_t end, int depth) {
    const std::int32_t count = end - begin;
    Imath::Box3f all;
    for (std::int32_t k = begin; k < end; ++k) all.extendBy(boxes_[orders_[0][k]]);
    float best = float(count) - 2 * kBox;  // of not splitting, over the cost of a surface
    int axis = -1;
    std::int32_t left = 0;
    for (int k = 0; k < 3 && depth < packet::kDeepest; ++k) {
      const std::int32_t* order = orders_[k].data() + begin;
      Imath::Box3f sum;
      for (std::int32_t i = count; i-- > 1;) {
        sum.extendBy(boxes_[order[i]]);
        above_[i] = half_area(sum);
      }
      sum.makeEmpty();
      for (std::int32_t i = 1; i < count; ++i) {
        sum.extendBy(boxes_[order[i - 1]]);
        const float cost = (half_area(sum) * float(i) + above_[i] * float(count - i)) / half_area(all);
        if (cost < best) best = cost, axis = k, left = i;
      }
    }
    packet::Node& node = nodes_[at];
    for (int k = 0; k < 3; ++k) {
      node.planes[k] = all.min[k];
      node.planes[k + 3] = all.max[k];
    }
    node.first = begin;
    node.count = std::uint16_t(count);
    if (axis < 0) return;
    part(axis, begin, begin + left, end);
    const auto child = std::int32_t(nodes_.size());
    node.first = child;
    node.count = 0;
    node.axis = std::uint16_t(axis);
    nodes_.resize(nodes_.size() + 2);
    split(child, begin, begin + left, depth + 1);
    split(child + 1, begin + left, end, depth + 1);
  }

  /// Puts the items that come before `middle` along one axis before the others along the other axes too.
  void part(int axis, std::int32_t begin, std::int32_t middle, std::int32_t end) {
    for (std::int32_t k = begin; k < end; ++k) goes_left_[orders_[axis][k]] = k < middle;
    for (int other = 0; other < 3; ++other) {
      if (other == axis) continue;
      std::int32_t* order = orders_[other].data();
      std::int32_t left = begin, right = 0;
      for (std::int32_t k = begin; k < end; ++k)
        if (goes_left_[order[k]] != 0)
          order[left++] = order[k];
        else
          right_[right++] = order[k];
      std::copy_n(right_.data(), right, order + left);
    }
  }

  const std::vector<Imath::Box3f>& boxes_;
  std::vector<PrimitiveReference>& items_;
  std::vector<packet::Node>& nodes_;
  std::array<std::vector<std::int32_t>, 3> orders_;  ///< Of items along each axis, node by node.
  std::vector<float> above_;                         ///< Half the surface of what comes from an item on.
  std::vector<std::uint8_t> goes_left_;              ///< By item.
  std::vector<std::int32_t> right_;
};

}  // namespace

bool PacketTracer::add_quad(const std::array<Vec3d, 4>& c, double precision, std::int32_t index) {
  const Vec3d e1 = c[1] - c[0], e3 = c[3] - c[0];
  const bool plane = c[2] == c[3] || std::abs((c[2] - c[0]) ^ (e1 % e3).normalized()) <= precision;
  const Vec2f shape = plane ? quad_shape(c) : Vec2f(0, 1);
  add_facet(c[0], e1, e3, shape, precision, false);
  if (!plane) add_facet(c[2], c[3] - c[2], c[1] - c[2], {0, 1}, precision, true);
  Imath::Box3d box;
  for (const Vec3d& corner : c) box.extendBy(corner);
  box.min -= Vec3d(precision);
  box.max += Vec3d(precision);
  for (std::size_t k = facets_.size() - (plane ? 1 : 2); k < facets_.size(); ++k) add_reference(2 * index, k, box);
  return plane;
}

void PacketTracer::add_facet(const Vec3d& corner, const Vec3d& along_s, const Vec3d& along_t, const Vec2f& shape,
                             double precision, bool second) {
  const Vec3d normal = along_s % along_t;
  const double scale = 1.0 / (normal ^ normal);
  const Vec3d s = (along_t % normal) * scale, t = (normal % along_s) * scale;
  packet::Facet f{};
  copy_to(f.corner, corner);
  copy_to(f.normal, normal.normalized());
  copy_to(f.s, s);
  copy_to(f.t, t);
  f.third[0] = shape.y, f.third[1] = shape.x - 1.0f;
  f.fourth[0] = shape.x, f.fourth[1] = shape.y - 1.0f;
  const std::array<Vec3d, 4> gradients{s, t, t * double(f.third[1]) - s * double(f.third[0]),
                                       s * double(f.fourth[1]) - t * double(f.fourth[0])};
  for (int k = 0; k < 4; ++k) f.rounding[k] = -float(precision * gradients[k].length());
  f.sign = 1.0f;
  if (second) f.start = 1.0f, f.sign = -1.0f;
  facets_.push_back(f);
}

void PacketTracer::add_sphere(const Vec3d& center, double radius, std::int32_t index) {
  packet::Ball ball{{}, float(radius)};
  copy_to(ball.center, center);
  balls_.push_back(ball);
  const Vec3d reach(radius * (1 + 1e-6));
  add_reference(2 * index + 1, balls_.size() - 1, {center - reach, center + reach});
}

void PacketTracer::add_reference(std::int32_t surface, std::size_t shape, const Imath::Box3d& box) {
  items_.push_back({surface, std::int32_t(shape)});
  boxes_.emplace_back(Vec3f(box.min), Vec3f(box.max));
}

void PacketTracer::build() {
  if (items_.empty()) return;
  TreeBuilder(boxes_, items_, nodes_).build();
  boxes_ = {};
  std::vector<packet::Facet> in_order;  // of their leaves, so that what is met together lies together
  in_order.reserve(facets_.size());
  for (PrimitiveReference& item : items_) {
    if (item.surface % 2 != 0) continue;
    in_order.push_back(facets_[item.shape]);
    item.shape = std::int32_t(in_order.size()) - 1;
  }
  facets_ = std::move(in_order);
}

}  // namespace patchlight

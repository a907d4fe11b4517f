#include <ImathBox.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "pipeline/optics/intersect/packet_tracer.h"
#include "pipeline/optics/intersect/rounding.h"

namespace patchlight {

namespace {

// Of a corner's coordinate, relative to it: rounded once in the scene's file and once in the local frame.
constexpr double kCornerError = 2 * kUnitRoundoff;

// Widening of the boxes, relative to the largest coordinate of the scene R. The slab test moves their planes by up to
// 3 u (R + the ray origin's coordinate), so this suffices for origins as far as 4 R from the centre. It costs a few
// more box tests, but does not change what a ray hits.
constexpr double kBoxError = 16 * kUnitRoundoff;

constexpr float kBoxCost = 1.0f;  // measured cost of a box test, relative to a primitive test

using packet::PrimitiveReference;

void copy_to(float (&to)[3], const Vec3d& from) {
  for (int k = 0; k < 3; ++k) to[k] = float(from[k]);
}

float half_area(const Imath::Box3f& box) {
  const Vec3f size = box.size();
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

/// Builds a BVH by the surface area heuristic (MacDonald and Booth 1990), testing every split along every axis.
/// References are sorted once along each axis; partitioning keeps their order.
class BvhBuilder {
 public:
  BvhBuilder(const std::vector<Imath::Box3f>& boxes, std::vector<PrimitiveReference>& references,
             std::vector<packet::Node>& nodes)
      : boxes_(boxes),
        references_(references),
        nodes_(nodes),
        right_half_area_(references.size()),
        goes_left_(references.size()),
        right_order_(references.size()) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto key = [&](std::int32_t k) {
        return std::pair(boxes[k].min[axis] + boxes[k].max[axis], references[k].surface);
      };
      orders_[axis].resize(references.size());
      std::iota(orders_[axis].begin(), orders_[axis].end(), 0);
      std::sort(orders_[axis].begin(), orders_[axis].end(),
                [&](std::int32_t a, std::int32_t b) { return key(a) < key(b); });
    }
  }

  /// Builds the nodes, and sorts the references by leaf.
  void build() {
    nodes_.resize(1);
    split(0, 0, std::int32_t(references_.size()), 0);
    std::vector<PrimitiveReference> sorted;
    sorted.reserve(references_.size());
    for (const std::int32_t k : orders_[0]) sorted.push_back(references_[k]);
    references_ = std::move(sorted);
  }

 private:
  void split(std::int32_t node_index, std::int32_t begin, std::int32_t end, int depth) {
    const std::int32_t count = end - begin;
    Imath::Box3f node_bounds;
    for (std::int32_t k = begin; k < end; ++k) node_bounds.extendBy(boxes_[orders_[0][k]]);
    float best = float(count) - 2 * kBoxCost;  // cost of a leaf, less that of a split's two boxes
    int axis = -1;
    std::int32_t left = 0;
    for (int k = 0; k < 3 && depth < packet::kMaxDepth; ++k) {
      const std::int32_t* order = orders_[k].data() + begin;
      Imath::Box3f bounds;
      for (std::int32_t i = count; i-- > 1;) {
        bounds.extendBy(boxes_[order[i]]);
        right_half_area_[i] = half_area(bounds);
      }
      bounds.makeEmpty();
      for (std::int32_t i = 1; i < count; ++i) {
        bounds.extendBy(boxes_[order[i - 1]]);
        const float cost =
            (half_area(bounds) * float(i) + right_half_area_[i] * float(count - i)) / half_area(node_bounds);
        if (cost < best) best = cost, axis = k, left = i;
      }
    }
    packet::Node& node = nodes_[node_index];
    for (int k = 0; k < 3; ++k) {
      node.planes[k] = node_bounds.min[k];
      node.planes[k + 3] = node_bounds.max[k];
    }
    node.first = begin;
    node.count = count;
    if (axis < 0) return;
    partition(axis, begin, begin + left, end);
    const auto child = std::int32_t(nodes_.size());
    node.first = child;
    node.count = ~axis;
    nodes_.resize(nodes_.size() + 2);
    split(child, begin, begin + left, depth + 1);
    split(child + 1, begin + left, end, depth + 1);
  }

  /// Partitions the other axes' orders like `axis`, whose references before `middle` belong to the left child.
  void partition(int axis, std::int32_t begin, std::int32_t middle, std::int32_t end) {
    for (std::int32_t k = begin; k < end; ++k) goes_left_[orders_[axis][k]] = k < middle;
    for (int other = 0; other < 3; ++other) {
      if (other == axis) continue;
      std::int32_t* order = orders_[other].data();
      std::int32_t left = begin, right = 0;
      for (std::int32_t k = begin; k < end; ++k)
        if (goes_left_[order[k]] != 0)
          order[left++] = order[k];
        else
          right_order_[right++] = order[k];
      std::copy_n(right_order_.data(), right, order + left);
    }
  }

  const std::vector<Imath::Box3f>& boxes_;
  std::vector<PrimitiveReference>& references_;
  std::vector<packet::Node>& nodes_;
  std::array<std::vector<std::int32_t>, 3> orders_;  ///< References of each node, sorted along each axis.
  std::vector<float> right_half_area_;               ///< Half the surface area of the bounds from each reference on.
  std::vector<std::uint8_t> goes_left_;              ///< [references]
  std::vector<std::int32_t> right_order_;
};

}  // namespace

bool PacketTracer::add_quad(const std::array<Vec3d, 4>& c, std::int32_t index) {
  // By the diagonals, since a plane by two short edges that meet at a flat angle is far off at the other corners.
  const Vec3d normal = ((c[2] - c[0]) % (c[3] - c[1])).normalized();
  double size = 0;
  for (const Vec3d& corner : c) size = std::max(size, absolute_dot(normal, corner));
  const bool planar = c[2] == c[3] || std::abs((c[1] - c[0]) ^ normal) <= 2 * kCornerError * size;
  if (planar) {
    add_facet(c, normal, 2 * index, false);
    return true;
  }
  add_facet({c[0], c[1], c[3], c[3]}, ((c[1] - c[0]) % (c[3] - c[0])).normalized(), 2 * index, false);
  add_facet({c[2], c[3], c[1], c[1]}, ((c[3] - c[2]) % (c[1] - c[2])).normalized(), 2 * index, true);
  return false;
}

void PacketTracer::add_facet(const std::array<Vec3d, 4>& c, const Vec3d& normal, std::int32_t surface, bool second) {
  const Vec3d e1 = c[1] - c[0], e3 = c[3] - c[0], area = e1 % e3;
  double height = 0;  // largest, of a corner above or below the plane
  for (const Vec3d& corner : c) height = std::max(height, std::abs((corner - c[0]) ^ normal));
  packet::Facet f{};
  copy_to(f.corner, c[0]);
  copy_to(f.normal, normal);
  /// Sets the unit normal and overlap of edge k from corner a to b, and returns the distance of the corner c[0].
  const auto set_edge = [&](int k, float* to, const Vec3d& a, const Vec3d& b) {
    const Vec3d edge = (normal % (b - a)).normalized();
    const auto error = [&](const Vec3d& end) {
      return (packet::kPlaneError * absolute_dot(normal, end - c[0]) +
              packet::kEdgeError * absolute_dot(edge, end - c[0])) /
                 packet::kMinCosine +
             kUnitRoundoff * (absolute_dot(normal, end) + absolute_dot(edge, end));
    };
    for (int axis = 0; axis < 3; ++axis) to[axis] = float(edge[axis]);
    f.overlap[k] = float(std::max(error(a), error(b)) + height);
    return float(edge ^ (c[0] - a));
  };
  set_edge(0, f.s, c[3], c[0]);
  set_edge(1, f.t, c[0], c[1]);
  f.third[3] = set_edge(2, f.third, c[1], c[2]);
  f.fourth[3] = set_edge(3, f.fourth, c[2], c[3]);
  f.offset = second ? 1.0f : 0.0f;
  f.scale[0] = float((second ? -1 : 1) * e3.length() / area.length());
  f.scale[1] = float((second ? -1 : 1) * e1.length() / area.length());
  facets_.push_back(f);
  Imath::Box3d box;
  for (const Vec3d& corner : c) {
    box.extendBy(corner);
    box.extendBy(corner - normal * ((corner - c[0]) ^ normal));
  }
  add_reference(surface, facets_.size() - 1, box);
}

void PacketTracer::add_sphere(const Vec3d& center, double radius, std::int32_t index) {
  packet::Sphere sphere{{}, float(radius)};
  copy_to(sphere.center, center);
  spheres_.push_back(sphere);
  const Vec3d reach(radius);
  add_reference(2 * index + 1, spheres_.size() - 1, {center - reach, center + reach});
}

void PacketTracer::add_reference(std::int32_t surface, std::size_t shape, const Imath::Box3d& box) {
  references_.push_back({surface, std::int32_t(shape)});
  boxes_.emplace_back(Vec3f(box.min), Vec3f(box.max));
}

void PacketTracer::build() {
  if (references_.empty()) return;
  float largest = 0;
  for (const Imath::Box3f& box : boxes_)
    for (int k = 0; k < 3; ++k) largest = std::max({largest, -box.min[k], box.max[k]});
  for (Imath::Box3f& box : boxes_) {
    box.min -= Vec3f(float(kBoxError) * largest);
    box.max += Vec3f(float(kBoxError) * largest);
  }
  BvhBuilder(boxes_, references_, nodes_).build();
  boxes_ = {};
  std::vector<packet::Facet> leaf_order;  // facets of one leaf are contiguous in memory
  leaf_order.reserve(facets_.size());
  for (PrimitiveReference& reference : references_) {
    if (reference.surface % 2 != 0) continue;
    leaf_order.push_back(facets_[reference.shape]);
    reference.shape = std::int32_t(leaf_order.size()) - 1;
  }
  facets_ = std::move(leaf_order);
}

}  // namespace patchlight

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/optics/packet_tracer.h"
#include "pipeline/optics/quad_shape.h"

namespace patchlight {

namespace {

constexpr int kDeepest = 40;
constexpr float kBox = 0.7f;  // cost of a box over that of a surface, measured

using Corner = std::array<float, 3>;

Corner to_floats(const Vec3d& v) {
  return {float(v.x), float(v.y), float(v.z)};
}

float half_area(const Corner& low, const Corner& high) {
  const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
  return x * y + y * z + z * x;
}

struct Bounds {
  Corner low, high;

  Bounds() {
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
  }
  void add(const Corner& l, const Corner& h) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], l[k]);
      high[k] = std::max(high[k], h[k]);
    }
  }
};

}  // namespace

bool PacketTracer::add_quad(const std::array<Vec3d, 4>& c, double precision, std::int32_t index) {
  const Vec3d e1 = c[1] - c[0], e3 = c[3] - c[0];
  const bool plane = c[2] == c[3] || std::abs((c[2] - c[0]) ^ (e1 % e3).normalized()) <= precision;
  const Vec2f shape = plane ? quad_shape(c) : Vec2f(0, 1);
  add_facet(c[0], e1, e3, shape, precision, false);
  if (!plane) add_facet(c[2], c[3] - c[2], c[1] - c[2], {0, 1}, precision, true);
  Bounds bounds;
  for (const Vec3d& corner : c) bounds.add(to_floats(corner - Vec3d(precision)), to_floats(corner + Vec3d(precision)));
  for (std::size_t k = facets_.size() - (plane ? 1 : 2); k < facets_.size(); ++k)
    items_.push_back({2 * index, std::int32_t(k), bounds.low, bounds.high});
  return plane;
}

void PacketTracer::add_facet(const Vec3d& corner, const Vec3d& along_s, const Vec3d& along_t, const Vec2f& shape,
                             double precision, bool second) {
  const Vec3d normal = along_s % along_t;
  const double scale = 1.0 / (normal ^ normal);
  const Vec3d s = (along_t % normal) * scale, t = (normal % along_s) * scale;
  Facet f{to_floats(corner), to_floats(normal.normalized()), to_floats(s), to_floats(t), {}, {}, {}, 0.0f, 1.0f};
  f.third = {shape.y, shape.x - 1.0f};
  f.fourth = {shape.x, shape.y - 1.0f};
  const auto rounding = [&](const Vec3d& gradient) { return -float(precision * gradient.length()); };
  f.rounding = {rounding(s), rounding(t), rounding(t * double(f.third[1]) - s * double(f.third[0])),
                rounding(s * double(f.fourth[1]) - t * double(f.fourth[0]))};
  if (second) f.start = 1.0f, f.sign = -1.0f;
  facets_.push_back(f);
}

void PacketTracer::add_sphere(const Vec3d& center, double radius, std::int32_t index) {
  const Vec3d reach(radius * (1 + 1e-6));
  balls_.push_back({to_floats(center), float(radius)});
  items_.push_back(
      {2 * index + 1, std::int32_t(balls_.size() - 1), to_floats(center - reach), to_floats(center + reach)});
}

void PacketTracer::build() {
  if (items_.empty()) return;
  nodes_.resize(1);
  split(0, 0, std::int32_t(items_.size()), 0);
}

/// By the surface area heuristic (MacDonald and Booth 1990), exactly: every place between two items, along every axis.
void PacketTracer::split(std::int32_t at, std::int32_t begin, std::int32_t end, int depth) {
  Bounds all;
  for (std::int32_t k = begin; k < end; ++k) all.add(items_[k].low, items_[k].high);
  const auto first = items_.begin() + begin, last = items_.begin() + end;
  const auto count = std::size_t(end - begin);
  const auto along = [](int axis) {
    return [axis](const Item& a, const Item& b) {
      return std::pair(a.low[axis] + a.high[axis], a.surface) < std::pair(b.low[axis] + b.high[axis], b.surface);
    };
  };
  float best = float(count) - 2 * kBox;  // of not splitting, over the cost of a surface
  int axis = -1;
  std::size_t left = 0;
  std::vector<float> above(count);
  for (int k = 0; k < 3 && depth < kDeepest; ++k) {
    std::sort(first, last, along(k));
    Bounds sum;
    for (std::size_t i = count; i-- > 1;) {
      sum.add(first[i].low, first[i].high);
      above[i] = half_area(sum.low, sum.high);
    }
    sum = {};
    for (std::size_t i = 1; i < count; ++i) {
      sum.add(first[i - 1].low, first[i - 1].high);
      const float cost =
          (half_area(sum.low, sum.high) * float(i) + above[i] * float(count - i)) / half_area(all.low, all.high);
      if (cost < best) best = cost, axis = k, left = i;
    }
  }
  nodes_[at] = {all.low, all.high, begin, end - begin, 0};
  if (axis < 0) return;
  std::sort(first, last, along(axis));
  const auto child = std::int32_t(nodes_.size());
  nodes_[at].first = child;
  nodes_[at].count = 0;
  nodes_[at].axis = axis;
  nodes_.resize(nodes_.size() + 2);
  split(child, begin, begin + std::int32_t(left), depth + 1);
  split(child + 1, begin + std::int32_t(left), end, depth + 1);
}

}  // namespace patchlight

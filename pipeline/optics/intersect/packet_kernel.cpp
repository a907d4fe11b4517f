#include "pipeline/optics/intersect/packet_kernel.h"

#include <immintrin.h>

// Compiled three times: PACKET_WIDTH lanes to a vector register.
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

namespace patchlight::packet {

namespace {

constexpr int kWidth = PACKET_WIDTH;
using Floats = float __attribute__((vector_size(4 * kWidth)));
using Ints = std::int32_t __attribute__((vector_size(4 * kWidth)));

inline Floats load(const float* from) {
  return *reinterpret_cast<const Floats*>(from);
}

inline void store(float* to, const Floats& value) {
  *reinterpret_cast<Floats*>(to) = value;
}

inline Floats least(const Floats& a, const Floats& b) {
  return a < b ? a : b;
}

inline Floats most(const Floats& a, const Floats& b) {
  return a > b ? a : b;
}

inline bool any(const Ints& mask) {
#if PACKET_WIDTH == 16
  return _mm512_test_epi32_mask(reinterpret_cast<const __m512i&>(mask), reinterpret_cast<const __m512i&>(mask)) != 0;
#elif PACKET_WIDTH == 8
  return _mm256_movemask_ps(reinterpret_cast<const __m256&>(mask)) != 0;
#else
  return _mm_movemask_ps(reinterpret_cast<const __m128&>(mask)) != 0;
#endif
}

/// What rays have in common for all boxes: the way to the plane where an axis has the value p is p * inverse - start.
struct alignas(64) RayInverse {
  float inverse[3][kLanes], start[3][kLanes];
  bool mixed = false;              ///< Some rays go one way along an axis, some the other.
  std::int32_t first[3], last[3];  ///< Of a box's planes, which they meet first and last, if not.

  explicit RayInverse(const Rays& r) {
    constexpr float kSteep = 1e30f;  // for one over nothing, so that all stay numbers
    for (int k = 0; k < 3; ++k) {
      bool forwards = false, backwards = false;
      for (int lane = 0; lane < kLanes; lane += kWidth) {
        const Floats d = load(r.direction[k] + lane);
        const Floats i = (d > 1 / kSteep) | (d < -1 / kSteep) ? 1.0f / d : kSteep - Floats{};
        store(inverse[k] + lane, i);
        store(start[k] + lane, load(r.origin[k] + lane) * i);
        const Ints wanted = load(r.near + lane) <= load(r.far + lane);
        forwards = forwards || any(wanted & (i > 0.0f));
        backwards = backwards || any(wanted & (i < 0.0f));
      }
      mixed = mixed || (forwards && backwards);
      first[k] = backwards ? k + 3 : k;
      last[k] = backwards ? k : k + 3;
    }
  }
};

/// Which lanes of a vector go through a box.
template <bool kMixed>
inline Ints entered(const Rays& r, const RayInverse& ray, const Node& n, int lane) {
  Floats enter = load(r.near + lane), leave = load(r.far + lane);
  for (int k = 0; k < 3; ++k) {
    const Floats inverse = load(ray.inverse[k] + lane), start = load(ray.start[k] + lane);
    const Floats a = n.planes[kMixed ? k : ray.first[k]] * inverse - start;
    const Floats b = n.planes[kMixed ? k + 3 : ray.last[k]] * inverse - start;
    // In this order, what is not a number changes nothing.
    enter = most(kMixed ? least(a, b) : a, enter);
    leave = least(kMixed ? most(a, b) : b, leave);
  }
  return enter <= leave;
}

/// The lanes of a vector, kept in registers over the surfaces of a leaf.
struct Lanes {
  Floats ox, oy, oz, dx, dy, dz, near, far, s, t;
  Ints surface;

  Lanes(const Rays& r, int lane)
      : ox(load(r.origin[0] + lane)),
        oy(load(r.origin[1] + lane)),
        oz(load(r.origin[2] + lane)),
        dx(load(r.direction[0] + lane)),
        dy(load(r.direction[1] + lane)),
        dz(load(r.direction[2] + lane)),
        near(load(r.near + lane)),
        far(load(r.far + lane)),
        s(load(r.s + lane)),
        t(load(r.t + lane)),
        surface(*reinterpret_cast<const Ints*>(r.surface + lane)) {}

  void store_to(Rays& r, int lane) const {
    store(r.far + lane, far);
    store(r.s + lane, s);
    store(r.t + lane, t);
    *reinterpret_cast<Ints*>(r.surface + lane) = surface;
  }

  void intersect(const Facet& f, std::int32_t which) {
    const Floats x = ox - f.corner[0], y = oy - f.corner[1], z = oz - f.corner[2];
    const Floats distance = -(x * f.normal[0] + y * f.normal[1] + z * f.normal[2]) /
                            (dx * f.normal[0] + dy * f.normal[1] + dz * f.normal[2]);
    if (!any((distance > near) & (distance < far))) return;
    const Floats px = x + distance * dx, py = y + distance * dy, pz = z + distance * dz;
    const Floats fs = px * f.s[0] + py * f.s[1] + pz * f.s[2];
    const Floats ft = px * f.t[0] + py * f.t[1] + pz * f.t[2];
    const Floats third = f.third[0] * (1.0f - fs) + f.third[1] * ft;
    const Floats fourth = f.fourth[0] * (1.0f - ft) + f.fourth[1] * fs;
    const Ints hit = (fs >= f.rounding[0]) & (ft >= f.rounding[1]) & (third >= f.rounding[2]) &
                     (fourth >= f.rounding[3]) & (distance > near) & (distance < far);
    far = hit ? distance : far;
    s = hit ? f.start + f.sign * fs : s;
    t = hit ? f.start + f.sign * ft : t;
    surface = hit ? which - Ints{} : surface;
  }

  void intersect(const Ball& b, std::int32_t which) {
    const Floats x = b.center[0] - ox, y = b.center[1] - oy, z = b.center[2] - oz;
    const Floats scale = 1.0f / (dx * dx + dy * dy + dz * dz);
    const Floats middle = (x * dx + y * dy + z * dz) * scale;
    const Floats off_x = x - middle * dx, off_y = y - middle * dy, off_z = z - middle * dz;
    const Floats inside = b.radius * b.radius - (off_x * off_x + off_y * off_y + off_z * off_z);
    Floats half = most(inside, Floats{}) * scale;
    for (int k = 0; k < kWidth; ++k) half[k] = __builtin_sqrtf(half[k]);
    const Floats enter = middle - half, leave = middle + half;
    const Floats distance = enter > near ? enter : leave;
    const Ints hit = (inside >= 0.0f) & (distance > near) & (distance < far);
    far = hit ? distance : far;
    surface = hit ? which - Ints{} : surface;
  }
};

std::uint32_t blocked(const Rays& rays) {
  std::uint32_t bits = 0;
  for (int lane = 0; lane < kLanes; ++lane) bits |= std::uint32_t(rays.surface[lane] >= 0) << lane;
  return bits;
}

/// Nodes from near to far, as the first lane goes.
template <bool kMixed>
void traverse(const Tree& tree, Rays& rays, const RayInverse& ray, std::uint32_t wanted) {
  std::int32_t stack[kDeepest + 2];
  int waiting = 0;
  stack[waiting++] = 0;
  while (waiting > 0) {
    const Node& node = tree.nodes[stack[--waiting]];
    int lane = 0;
    while (lane < kLanes && !any(entered<kMixed>(rays, ray, node, lane))) lane += kWidth;
    if (lane == kLanes) continue;
    if (node.count == 0) {
      const bool backwards = rays.direction[node.axis][0] < 0;
      stack[waiting++] = node.first + !backwards;
      stack[waiting++] = node.first + backwards;
      continue;
    }
    do {
      Lanes lanes(rays, lane);
      for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
        const PrimitiveReference& item = tree.items[k];
        if (item.surface % 2 == 0)
          lanes.intersect(tree.facets[item.shape], item.surface);
        else
          lanes.intersect(tree.balls[item.shape], item.surface);
      }
      lanes.store_to(rays, lane);
      do lane += kWidth;
      while (lane < kLanes && !any(entered<kMixed>(rays, ray, node, lane)));
    } while (lane < kLanes);
    if (wanted != 0 && (wanted & ~blocked(rays)) == 0) return;
  }
}

}  // namespace

void JOIN(trace_by_, PACKET_WIDTH)(const Tree& tree, Rays& rays, std::uint32_t wanted) {
  const RayInverse inverse(rays);
  inverse.mixed ? traverse<true>(tree, rays, inverse, wanted) : traverse<false>(tree, rays, inverse, wanted);
}

}  // namespace patchlight::packet

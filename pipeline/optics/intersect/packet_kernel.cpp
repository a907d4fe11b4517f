#include "pipeline/optics/intersect/packet_kernel.h"

#include <immintrin.h>

// Compiled for each PACKET_WIDTH, the number of lanes of a vector register.
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

inline Floats minimum(const Floats& a, const Floats& b) {
  return a < b ? a : b;
}

inline Floats maximum(const Floats& a, const Floats& b) {
  return a > b ? a : b;
}

inline Floats square_root(Floats a) {
  for (int k = 0; k < kWidth; ++k) a[k] = __builtin_sqrtf(a[k]);
  return a;
}

/// The lanes of a mask, a bit each.
inline std::uint32_t bits(const Ints& mask) {
#if PACKET_WIDTH == 16
  return _mm512_movepi32_mask(reinterpret_cast<const __m512i&>(mask));
#elif PACKET_WIDTH == 8
  return std::uint32_t(_mm256_movemask_ps(reinterpret_cast<const __m256&>(mask)));
#else
  return std::uint32_t(_mm_movemask_ps(reinterpret_cast<const __m128&>(mask)));
#endif
}

inline bool any(const Ints& mask) {
  return bits(mask) != 0;
}

/// Whether any lane has a <= b.
inline bool any_ordered(const Floats& a, const Floats& b) {
#if PACKET_WIDTH == 16  // g++ takes a detour through a vector
  return _mm512_cmp_ps_mask(reinterpret_cast<const __m512&>(a), reinterpret_cast<const __m512&>(b), _CMP_LE_OQ) != 0;
#else
  return any(a <= b);
#endif
}

/// Whether any lane has a < b and b < c.
inline bool any_between(const Floats& a, const Floats& b, const Floats& c) {
#if PACKET_WIDTH == 16
  const __m512 middle = reinterpret_cast<const __m512&>(b);
  const __mmask16 above = _mm512_cmp_ps_mask(reinterpret_cast<const __m512&>(a), middle, _CMP_LT_OQ);
  return _mm512_mask_cmp_ps_mask(above, middle, reinterpret_cast<const __m512&>(c), _CMP_LT_OQ) != 0;
#else
  return any((a < b) & (b < c));
#endif
}

/// Per-ray constants of the slab test: a ray hits the plane at coordinate p of an axis at t = p * inverse -
/// scaled_origin.
struct alignas(64) RayInverse {
  float inverse[3][kLanes], scaled_origin[3][kLanes];
  bool mixed_signs = false;                  ///< Whether the directions differ in sign along some axis.
  std::int32_t near_plane[3], far_plane[3];  ///< Unless mixed: the planes of a box that rays hit first and last.

  explicit RayInverse(const Rays& r) {
    constexpr float kMaxInverse = 1e30f;  // for direction components near 0, to avoid NaN
    for (int k = 0; k < 3; ++k) {
      bool forwards = false, backwards = false;
      for (int lane = 0; lane < kLanes; lane += kWidth) {
        const Floats d = load(r.direction[k] + lane);
        const Floats i = (d > 1 / kMaxInverse) | (d < -1 / kMaxInverse) ? 1.0f / d : kMaxInverse - Floats{};
        store(inverse[k] + lane, i);
        store(scaled_origin[k] + lane, load(r.origin[k] + lane) * i);
        const Ints active = load(r.near + lane) <= load(r.far + lane);
        forwards = forwards || any(active & (i > 0.0f));
        backwards = backwards || any(active & (i < 0.0f));
      }
      mixed_signs = mixed_signs || (forwards && backwards);
      near_plane[k] = backwards ? k + 3 : k;
      far_plane[k] = backwards ? k : k + 3;
    }
  }
};

/// Whether any of a vector's lanes hits a node's box.
template <bool kMixedSigns>
inline bool hits_box(const Rays& r, const RayInverse& ray, const Node& n, int lane) {
  Floats entry = load(r.near + lane), exit = load(r.far + lane);
  for (int k = 0; k < 3; ++k) {
    const Floats inverse = load(ray.inverse[k] + lane), scaled_origin = load(ray.scaled_origin[k] + lane);
    const Floats a = n.planes[kMixedSigns ? k : ray.near_plane[k]] * inverse - scaled_origin;
    const Floats b = n.planes[kMixedSigns ? k + 3 : ray.far_plane[k]] * inverse - scaled_origin;
    // With this order of operands, NaN is ignored.
    entry = maximum(kMixedSigns ? minimum(a, b) : a, entry);
    exit = minimum(kMixedSigns ? maximum(a, b) : b, exit);
  }
  return any_ordered(entry, exit);
}

/// A vector's lanes, kept in registers while they are intersected with the primitives of a leaf.
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

  void intersect(const Facet& f, std::int32_t id) {
    const Floats x = ox - f.corner[0], y = oy - f.corner[1], z = oz - f.corner[2];
    const Floats distance = -(x * f.normal[0] + y * f.normal[1] + z * f.normal[2]) /
                            (dx * f.normal[0] + dy * f.normal[1] + dz * f.normal[2]);
    if (!any_between(near, distance, far)) return;
    const Floats px = x + distance * dx, py = y + distance * dy, pz = z + distance * dz;
    const Floats limit = float(-kRayError / kMinCosine) * distance;
    const Floats fs = px * f.s[0] + py * f.s[1] + pz * f.s[2];
    const Floats ft = px * f.t[0] + py * f.t[1] + pz * f.t[2];
    const Floats third = px * f.third[0] + py * f.third[1] + pz * f.third[2] + f.third[3];
    const Floats fourth = px * f.fourth[0] + py * f.fourth[1] + pz * f.fourth[2] + f.fourth[3];
    const Ints hit = (fs + f.overlap[0] >= limit) & (ft + f.overlap[1] >= limit) & (third + f.overlap[2] >= limit) &
                     (fourth + f.overlap[3] >= limit) & (distance > near) & (distance < far);
    far = hit ? distance : far;
    s = hit ? f.offset + f.scale[0] * fs : s;
    t = hit ? f.offset + f.scale[1] * ft : t;
    surface = hit ? id - Ints{} : surface;
  }

  void intersect(const Sphere& b, std::int32_t id) {
    const Floats x = b.center[0] - ox, y = b.center[1] - oy, z = b.center[2] - oz;
    const Floats inverse_square = 1.0f / (dx * dx + dy * dy + dz * dz);
    const Floats t_middle = (x * dx + y * dy + z * dz) * inverse_square;
    const Floats off_x = x - t_middle * dx, off_y = y - t_middle * dy, off_z = z - t_middle * dz;
    const Floats discriminant = b.radius * b.radius - (off_x * off_x + off_y * off_y + off_z * off_z);
    const Floats half_chord = square_root(maximum(discriminant, Floats{}) * inverse_square);
    const Floats entry = t_middle - half_chord, exit = t_middle + half_chord;
    const Floats distance = entry > near ? entry : exit;
    const Ints hit = (discriminant >= 0.0f) & (distance > near) & (distance < far);
    far = hit ? distance : far;
    surface = hit ? id - Ints{} : surface;
  }
};

std::uint32_t hit_lanes(const Rays& rays) {
  std::uint32_t lanes = 0;
  for (int lane = 0; lane < kLanes; lane += kWidth)
    lanes |= bits(*reinterpret_cast<const Ints*>(rays.surface + lane) >= 0) << lane;
  return lanes;
}

/// Traverses the nodes front to back, in the order of the first lane.
template <bool kMixedSigns>
void traverse(const Bvh& bvh, Rays& rays, const RayInverse& ray, std::uint32_t occlusion_lanes) {
  std::int32_t stack[kMaxDepth + 2];
  int stack_size = 0;
  stack[stack_size++] = 0;
  while (stack_size > 0) {
    const Node& node = bvh.nodes[stack[--stack_size]];
    int lane = 0;
    while (lane < kLanes && !hits_box<kMixedSigns>(rays, ray, node, lane)) lane += kWidth;
    if (lane == kLanes) continue;
    if (node.count < 0) {
      const bool backwards = rays.direction[~node.count][0] < 0;
      stack[stack_size++] = node.first + !backwards;
      stack[stack_size++] = node.first + backwards;
      continue;
    }
    do {
      Lanes lanes(rays, lane);
      for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
        const PrimitiveReference& reference = bvh.references[k];
        if (reference.surface % 2 == 0)
          lanes.intersect(bvh.facets[reference.shape], reference.surface);
        else
          lanes.intersect(bvh.spheres[reference.shape], reference.surface);
      }
      lanes.store_to(rays, lane);
      do lane += kWidth;
      while (lane < kLanes && !hits_box<kMixedSigns>(rays, ray, node, lane));
    } while (lane < kLanes);
    if (occlusion_lanes != 0 && (occlusion_lanes & ~hit_lanes(rays)) == 0) return;
  }
}

}  // namespace

void JOIN(trace_width_, PACKET_WIDTH)(const Bvh& bvh, Rays& rays, std::uint32_t occlusion_lanes) {
  const RayInverse ray(rays);
  ray.mixed_signs ? traverse<true>(bvh, rays, ray, occlusion_lanes) : traverse<false>(bvh, rays, ray, occlusion_lanes);
}

}  // namespace patchlight::packet

#pragma once
#include <cstdint>

// Plain data only: code that includes this header is compiled once for each vector width.
namespace patchlight::packet {

constexpr int kLanes = 16;

/// A quad or a triangle: the points of its plane where four linear functions, s, t, `third_edge` and `fourth_edge`, are
/// at least their tolerance, a small negative number.
struct Facet {
  float corner[3], normal[3], s[3], t[3];  ///< A corner, the unit normal, and the gradients of s and t.
  float third_edge[2], fourth_edge[2];     ///< (x,y) of x (1 - s) + y t and of x (1 - t) + y s.
  float tolerance[4];
  float offset, sign;  ///< The hit's (s,t) is offset + sign * (s,t) of the facet.
};

struct Sphere {
  float center[3];
  float radius;
};

/// An entry of a BVH leaf.
struct PrimitiveReference {
  std::int32_t surface;  ///< 2 * index for a quad, 2 * index + 1 for a sphere.
  std::int32_t shape;    ///< Index of its facet or sphere.
};

/// A BVH node with its bounding box.
struct alignas(32) Node {
  float planes[6];      ///< Of its box: minimum x, y, z, then maximum x, y, z.
  std::int32_t first;   ///< Leaf: first primitive reference; else the first of two children.
  std::uint16_t count;  ///< Leaf: number of primitive references; else 0.
  std::uint16_t axis;   ///< Split axis of the children.
};

constexpr int kMaxDepth = 48;  ///< Of the BVH.

/// A bounding volume hierarchy.
struct Bvh {
  const Node* nodes;
  const PrimitiveReference* references;
  const Facet* facets;
  const Sphere* spheres;
};

/// Rays and their hits. Every array is aligned to 64 bytes.
struct Rays {
  const float *origin[3], *direction[3], *near;
  float* far;
  float *s, *t;
  alignas(64) std::int32_t surface[kLanes];  ///< See PrimitiveReference; -1: no hit.
};

/// Finds the closest hit of each lane; or, if `occlusion_lanes` is not 0, stops as soon as all these lanes have any
/// hit.
using TraceFunction = void (*)(const Bvh& bvh, Rays& rays, std::uint32_t occlusion_lanes);

/// The kernel for the widest vector registers of this processor.
TraceFunction fastest_trace();

void trace_width_4(const Bvh& bvh, Rays& rays, std::uint32_t occlusion_lanes);
void trace_width_8(const Bvh& bvh, Rays& rays, std::uint32_t occlusion_lanes);
void trace_width_16(const Bvh& bvh, Rays& rays, std::uint32_t occlusion_lanes);

}  // namespace patchlight::packet

#pragma once
#include <cstdint>

// Plain data only: code that includes this header is compiled once for each vector width.
namespace patchlight::packet {

constexpr int kLanes = 16;

/// Bounds of rounding errors, with the unit roundoff u, for a ray from its origin o to a point p of a facet at distance
/// T, both relative to the facet's corner; n is the facet's normal (Higham 2002, section 3.1; Pharr et al. 2023,
/// section 6.8). o is rounded by u |o_k| in coordinate k, and |o_k| <= |p_k| + T. Its height over the plane is rounded
/// by 5 u sum |o_k n_k|: o and n by u each and the sum by 3 u. The ray's cosine is rounded by 4 u and their quotient by
/// 2 u. The computed point is thus off the plane by 5 u sum |p_k n_k| + 11 u T; since it is on the ray, it is off p by
/// this over the cosine. It is itself rounded by u (|p_k| + |o_k| + T), and its distance from an edge with the unit
/// normal e by 7 u sum |p_k e_k| more.
///
/// A facet therefore overlaps its edges by (kPlaneError sum |p_k n_k| + kEdgeError sum |p_k e_k| + kRayError T) /
/// kMinCosine, and by the rounding of the vertices: a ray that meets the edge of a facet with a larger cosine hits one
/// of the edge's facets. (To divide by each ray's cosine would take a sixth of the time.)
constexpr double kUnitRoundoff = 0x1p-24, kMinCosine = 0.25;
constexpr double kPlaneError = 5 * kUnitRoundoff, kEdgeError = 12 * kUnitRoundoff, kRayError = 14 * kUnitRoundoff;

/// A quad or a triangle: the points of its plane that are inside its edges, or outside by no more than overlap +
/// kRayError / kMinCosine * distance, along a ray with a direction of unit length. Positions are relative to the
/// corner.
struct Facet {
  float corner[3], normal[3];  ///< A corner and the unit normal.
  float s[3], t[3];            ///< Inward unit normals of the edges s = 0 and t = 0, which meet at the corner.
  float third[4], fourth[4];   ///< The same of the edges opposite to them, and the corner's distance from each.
  float overlap[4];            ///< At the edges s = 0, t = 0, third and fourth, m.
  float offset, scale[2];      ///< The hit's (s,t) is offset + scale * (distances from the edges s = 0 and t = 0).
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
  float planes[6];     ///< Of its box: minimum x, y, z, then maximum x, y, z.
  std::int32_t first;  ///< Leaf: first primitive reference; else the first of two children.
  std::int32_t count;  ///< Leaf: number of primitive references; else ~axis, the children's split axis.
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

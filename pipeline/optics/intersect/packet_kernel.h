#pragma once
#include <cstdint>

// Plain data alone: what this is for is compiled once for each kind of vector registers.
namespace patchlight::packet {

constexpr int kLanes = 16;

/// A quad or a triangle, inside which s, t, and two more functions of them are no less than minus their rounding.
struct Facet {
  float corner[3], normal[3], s[3], t[3];  ///< A corner, and the gradients of s and t from it.
  float third[2], fourth[2];               ///< The other sides: x (1 - s) + y t and x (1 - t) + y s.
  float rounding[4];
  float start, sign;  ///< (s,t) are start + sign * those of the facet.
};

struct Ball {
  float center[3];
  float radius;
};

struct PrimitiveReference {
  std::int32_t surface;  ///< Twice its index, and one more for a sphere.
  std::int32_t shape;    ///< Which facet or ball.
};

struct alignas(32) Node {
  float planes[6];      ///< Of its box: low and then high.
  std::int32_t first;   ///< Of its items, or the first of two children.
  std::uint16_t count;  ///< 0: it has children.
  std::uint16_t axis;   ///< Along which its children stand.
};

constexpr int kDeepest = 48;

/// A tree of boxes about surfaces.
struct Tree {
  const Node* nodes;
  const PrimitiveReference* items;
  const Facet* facets;
  const Ball* balls;
};

/// Rays, each array aligned to 64 bytes, and what they meet.
struct Rays {
  const float *origin[3], *direction[3], *near;
  float* far;
  float *s, *t;
  alignas(64) std::int32_t surface[kLanes];  ///< -1: nothing.
};

/// Finds the nearest surface in each lane's way, or, if `wanted` is not 0, goes on until there is any in all of those.
using Trace = void (*)(const Tree& tree, Rays& rays, std::uint32_t wanted);

/// For the widest registers of this processor.
Trace fastest();

void trace_by_4(const Tree& tree, Rays& rays, std::uint32_t wanted);
void trace_by_8(const Tree& tree, Rays& rays, std::uint32_t wanted);
void trace_by_16(const Tree& tree, Rays& rays, std::uint32_t wanted);

}  // namespace patchlight::packet

#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "pipeline/model/cuts/plane_frame.h"

namespace patchlight {

/// A straight line on a plane primitive along which another plane surface stands on it or crosses it: irradiance is
/// discontinuous there (Baum, Mann, Smith and Winget 1991, "Making radiosity usable").
struct Crossing {
  Vec2d from, to;       ///< In the primitive's PlaneFrame, m.
  double height = 0.0;  ///< Of the other surface's edge above the primitive, m; 0 if it crosses.
  double extent = 0.0;  ///< Size of all crossings of the primitive that are connected to this one, m.
  double relief = 0.0;  ///< How far the other surface rises above the primitive, m.
};

/// The crossings of plane primitives, inside of their outlines. A surface stands on primitive `i` where one of its
/// edges is no higher than reach(i), m; a negative reach: the primitive's crossings are not wanted. Coplanar surfaces,
/// spheres and surfaces with alpha masks make no crossings. Shape: [primitives].
std::vector<std::vector<Crossing>> find_crossings(const std::vector<Primitive>& primitives,
                                                  const std::function<double(std::int32_t)>& reach);

/// The same along the edges of the outlines.
std::vector<std::vector<Crossing>> find_crossings_at_edges(const std::vector<Primitive>& primitives,
                                                           const std::function<double(std::int32_t)>& reach);

/// The edges of regions' outlines as crossings without a height, each with an extent of its own. Shape: [primitives];
/// empty where there is no region.
std::vector<std::vector<Crossing>> outlines_of_regions(const std::vector<Primitive>& primitives);

}  // namespace patchlight

#pragma once
#include <optional>

#include "importers/mesh/mesh_topology.h"
#include "importers/mesh/surface.h"

namespace patchlight {

/// How far a facet's plane may lie inside the sphere, in radii. Blender's icosphere of 80 faces reaches 0.066, its UV
/// sphere of 32 x 16 0.010; an icosahedron's 0.205 and a cube's 0.42 stay outside.
constexpr double kLargestSagitta = 0.08;

/// The sphere that a closed mesh stands for: all its vertices lie on it within 1e-4 radii, all its facets within
/// kLargestSagitta, and it is covered once. Its radius is negative where the facets face inward.
std::optional<Sphere> recognize_sphere(const MeshTopology& topology, const MeshTopology::Component& component);

}  // namespace patchlight

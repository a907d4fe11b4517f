#pragma once
#include <optional>

#include "importers/mesh/mesh_topology.h"
#include "importers/mesh/surface.h"

namespace patchlight {

/// Largest distance of a facet's plane from the sphere, in radii. Blender's icosphere of 80 faces has 0.066, its UV
/// sphere of 32 x 16 has 0.010; an icosahedron with 0.205 and a cube with 0.42 are not spheres.
constexpr double kMaxSagitta = 0.08;

/// The sphere that a closed mesh approximates: all vertices lie on it within 1e-4 radii, all facets within kMaxSagitta,
/// they cover it once, and shading normals are the sphere's within 9 degrees. So flat-shaded balls are spheres from
/// about 32 x 16 facets on. The radius is negative if the facets face inward. Nothing for any other mesh.
std::optional<Sphere> recognize_sphere(const MeshTopology& topology, const MeshTopology::Component& component);

}  // namespace patchlight

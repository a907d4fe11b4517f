#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "importers/gltf/read/gltf_reader.h"
#include "importers/mesh/surface.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Texture coordinates of a primitive without any: NaN.
inline const Texcoords kNoTexcoords = [] {
  Texcoords none;
  none.fill(Vec2f(std::numeric_limits<float>::quiet_NaN()));
  return none;
}();

/// The scene's primitives so far, with statistics for the user.
struct PrimitiveList {
  std::vector<Primitive> primitives;
  std::vector<Texcoords> texcoords;  ///< By primitive, up to the last one with coordinates from the file.
  /// As texcoords, of emission textures whose mapping differs from the base colour's; otherwise kNoTexcoords.
  std::vector<Texcoords> emission_texcoords{};
  std::vector<Texcoords> metallic_roughness_texcoords{};  ///< The same for metallic-roughness textures.
  std::vector<Texcoords> normal_texcoords{};              ///< The same for normal textures.
  std::vector<CornerColors> colors;                       ///< By primitive, up to the last one with vertex colours.
  std::vector<CornerNormals> normals{};                   ///< By primitive, up to the last curved one.
  std::int32_t smooth_vertices = 0;                       ///< Number of smooth vertices.
  std::int64_t quads = 0;
  std::int64_t triangles = 0;
  std::int64_t spheres = 0;
  std::int64_t regions = 0;               ///< Planar regions.
  std::int64_t merged_triangles = 0;      ///< Triangles of merged coplanar regions,
  std::int64_t merged_facets = 0;         ///< and the facets that replace them.
  std::int64_t degenerate_triangles = 0;  ///< Skipped.
  std::int64_t added_triangles = 0;       ///< By splitting at vertices on open edges.
  std::int64_t invalid_normals = 0;       ///< Of corners: of no use for shading.
};

/// Indices of a quad's corners in the order of its back's, which reverses the winding and mirrors u.
std::array<std::size_t, 4> reversed_corners(const Primitive& front);

/// Recognises spheres, planar regions and quads among a surface's triangles and appends its primitives. Each primitive
/// of a double-sided material is followed by its back, unless the surface is closed, looks outwards and is dark inside.
void append_primitives(const Surface& surface, const SurfaceMaterial& material, const TriangleSoup& soup,
                       const std::function<bool()>& is_dark_inside, PrimitiveList& list);

}  // namespace patchlight

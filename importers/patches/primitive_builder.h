#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "importers/gltf/read/gltf_reader.h"
#include "importers/mesh/surface.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// Where there are no texture coordinates.
inline const Texcoords kNoTexcoords = [] {
  Texcoords none;
  none.fill(Vec2f(std::numeric_limits<float>::quiet_NaN()));
  return none;
}();

/// Primitives of a scene as they come together, and what they were made from.
struct PrimitiveList {
  std::vector<Primitive> primitives;
  std::vector<Texcoords> texcoords;  ///< Of the first primitives, up to the last one that has any from the file.
  std::vector<Texcoords> emission_texcoords{};  ///< The same of emission and finish textures that lie by other mappings
  std::vector<Texcoords> metallic_roughness_texcoords{};  ///< than base colour's; kNoTexcoords where they do not.
  std::vector<CornerColors> colors;                       ///< Of vertices, of the first primitives in the same way.
  std::int32_t smooth_vertices = 0;                       ///< Numbers in use.
  std::int64_t quads = 0;
  std::int64_t triangles = 0;
  std::int64_t spheres = 0;
  std::int64_t merged_triangles = 0;      ///< Of coplanar regions,
  std::int64_t merged_facets = 0;         ///< and the quads and triangles that they became.
  std::int64_t degenerate_triangles = 0;  ///< Triangles that were left out.
};

/// Recognises spheres and quads among a surface's triangles and appends its primitives; behind each of a double-sided
/// material stands the primitive of its other side.
void append_primitives(const Surface& surface, const SurfaceMaterial& material, const TriangleSoup& soup,
                       PrimitiveList& list);

}  // namespace patchlight

#pragma once
#include <ImathBox.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/model/camera.h"
#include "pipeline/model/environment.h"
#include "pipeline/model/light.h"
#include "pipeline/model/math.h"
#include "pipeline/model/provenance.h"
#include "pipeline/model/region.h"
#include "pipeline/model/shader.h"
#include "pipeline/model/texture.h"

namespace patchlight {

/// A surface that is divided into patches: a bilinear quad, a planar region or a sphere.
///
/// Quad: p(u,v) interpolates corners 0 (0,0), 1 (1,0), 2 (1,1), 3 (0,1) bilinearly; a triangle repeats its last corner.
/// Seen from the lit side, the corners run counter-clockwise.
/// Region: the part of a parallelogram that its outline and holes leave.
/// Sphere: u is the azimuth about world Y (0 at +X, growing towards -Z), v the polar angle from +Y, both in [0,1].
struct Primitive {
  enum class Shape : std::int32_t { quad = 0, sphere = 1 };

  Shape shape = Shape::quad;
  std::int32_t shader = -1;            ///< Index into PatchSet::shaders; -1: none.
  std::int32_t texture = -1;           ///< Base colour: index into PatchSet::textures; -1: none.
  std::int32_t emission_texture = -1;  ///< Index into PatchSet::textures; -1: none.
  /// Index into PatchSet::textures; -1: none. Green is roughness, blue is metalness, both linear.
  std::int32_t metallic_roughness_texture = -1;
  std::int32_t normal_texture = -1;  ///< Index into PatchSet::textures, of tangent space; -1: none.
  std::int32_t mask = -1;            ///< Alpha mask: index into PatchSet::masks; -1: none.
  std::array<Vec3d, 4> corners{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};  ///< m; zeros for a sphere.
  Vec3d sphere_center{0.0};                                                      ///< m; zero for a quad.
  double sphere_radius = 0.0;     ///< m; negative: lit inside. Zero for a quad.
  std::int32_t node = 0;          ///< Index into PatchSet::nodes.
  std::int32_t material = 0;      ///< Index into PatchSet::materials.
  std::int32_t light_group = -1;  ///< Index into PatchSet::light_groups; -1: does not emit.
  std::int32_t back = -1;         ///< The primitive of the other side of this surface, with u mirrored; -1: none.
  /// Ids of the corners' smooth vertices: corners with the same id meet without a crease. -1 for spheres.
  std::array<std::int32_t, 4> smooth_vertices{-1, -1, -1, -1};
  std::shared_ptr<const Region> region{};  ///< What there is of the quad, a parallelogram; null: all of it.
  double patch_area = 0.0;  ///< m2; the import's target for patches of its scale, however small the primitive is.
  bool intangible = false;  ///< A lamp that hides nothing: rays pass it, and camera rays add its light.

  bool is_triangle() const { return shape == Shape::quad && corners[2] == corners[3]; }
};

/// Whether any primitive is intangible.
inline bool has_intangible(const std::vector<Primitive>& primitives) {
  return std::any_of(primitives.begin(), primitives.end(), [](const Primitive& p) { return p.intangible; });
}

/// The dielectric layer over the diffuse part of a material, as glTF defines it. Its Fresnel reflectance follows the
/// exact curve of `ior`, scaled to run from `normal` to `grazing`; Schlick's (1994) where `ior` is 0.
struct Coat {
  Color normal{0.0f};     ///< Reflectance at normal incidence, each in [0,1]; 0: no coat, as of metal all over.
  float grazing = 1.0f;   ///< Reflectance at grazing incidence, in [0,1].
  float ior = 0.0f;       ///< Of the layer, at least 1; or 0.
  float metallic = 0.0f;  ///< The metallic part of the surface, in [0,1], which has no coat; times a texture's.

  bool exists() const { return normal != Color(0.0f); }
};

/// A clear coat of index 1.5 over all else, as glTF defines it (`KHR_materials_clearcoat`).
struct ClearCoat {
  float part = 0.0f;  ///< Of the surface that it covers, in [0,1]. 0: none.
  float roughness = 0.0f;

  bool exists() const { return part > 0; }
};

/// What a material lets through below its coat, as glTF defines it (`KHR_materials_transmission`, `_volume`).
struct Transmission {
  float part = 0.0f;   ///< Of the light that passes the coat, in [0,1]; the diffuse part has the rest. 0: all of it.
  Color tint{1.0f};    ///< Of what crosses the surface, each in [0,1]; times base colour.
  bool solid = false;  ///< The surface is that of a body, which refracts; else a thin sheet, straight through.
  float ior = 1.5f;    ///< Of the body, at least 1.
  Color absorption{0.0f};  ///< By the body, 1/m.

  bool exists() const { return part > 0; }
};

/// Properties that are constant over a material.
struct Material {
  std::string name;
  Color specular{0.0f};    ///< Specular reflectance (the metallic part), each in [0,1]; the mean if textured.
  float roughness = 1.0f;  ///< Of metal and coat, in [0,1]; the mean if textured.
  Color tint{1.0f};        ///< Diffuse reflectance, multiplied by texture and vertex colours if any.
  float alpha = 1.0f;      ///< Multiplied by the mask and the vertices' alpha.
  /// Alpha test: a masked primitive exists where its alpha is at least this. 0: it covers the part alpha of each place.
  float alpha_cutoff = 0.0f;
  Color metal{0.0f};  ///< If textured, specular reflectance is this times base colour and the texture's metalness.
  float roughness_factor = 1.0f;  ///< Multiplied by a texture's roughness.
  Color emission_tint{0.0f};      ///< Radiant exitance of a white texel of the emission texture, W/m2.
  Coat coat{};
  Transmission transmission{};
  float normal_scale = 1.0f;  ///< Of the x and y of normal textures.
  /// Part of the light below the coat that leaves the other side diffusely, each in [0,1]. 0: none.
  Color translucence{0.0f};
  ClearCoat clear_coat{};

  bool is_coated() const { return coat.exists() || clear_coat.exists(); }
};

/// Texture coordinates at corners 0 to 3 of a primitive, bilinear between them; shaders see them as (u,v).
using Texcoords = std::array<Vec2f, 4>;
inline const Texcoords kIdentityTexcoords{Vec2f(0, 0), Vec2f(1, 0), Vec2f(1, 1), Vec2f(0, 1)};

/// Linear vertex colours and alpha at corners 0 to 3 of a primitive, bilinear between them.
using CornerColors = std::array<Vec4f, 4>;
inline const CornerColors kWhiteVertices{Vec4f(1.0f), Vec4f(1.0f), Vec4f(1.0f), Vec4f(1.0f)};

/// Shading normals at corners 0 to 3 of a primitive, bilinear between them: unit vectors, or zeros where the surface's
/// own normal counts.
using CornerNormals = std::array<Vec3f, 4>;
inline const CornerNormals kFlatNormals{Vec3f(0.0f), Vec3f(0.0f), Vec3f(0.0f), Vec3f(0.0f)};

/// A piece of a primitive, or a cluster of facets, on which the solution is constant.
struct Patch {
  Vec3d center{0.0};   ///< m, world space: the surface point at the middle of the (u,v) range; of a cluster, near it.
  Vec3f normal{0.0f};  ///< Unit vector on the lit side; of a cluster, along the sum of its facets' area vectors.
  double area = 0.0;   ///< m2, true surface area.
  Color reflectance{0.0f};     ///< Diffuse, each in [0,1).
  Color emission{0.0f};        ///< Radiant exitance, W/m2.
  Color transmittance{1.0f};   ///< Part of the irradiance that passes the coat, on average over all directions.
  std::int32_t primitive = 0;  ///< Of a cluster, its first facet.
  /// Number of facets of a cluster: whole plane quads of a mesh, which are primitives that follow each other. 0: the
  /// patch is no cluster.
  std::int32_t facets = 0;
  float u0 = 0, v0 = 0, u1 = 1, v1 = 1;  ///< Zeros of a cluster.
  /// Fraction of the area that passes the alpha test. Reflectance, emission and irradiance refer to that part.
  float coverage = 1.0f;
  std::int32_t cut = -1;    ///< First of the cuts through its cell, into PatchSet::cuts; -1: the patch is the cell.
  std::uint8_t closed = 0;  ///< Bit k: other surfaces stand along edge k: v = v0, u = u1, v = v1, u = u0.
  /// m; the corners of triangles that tile a part of a cell, counter-clockwise; empty: the whole cell.
  std::vector<Vec3d> triangles;

  double covered_area() const { return area * double(coverage); }          ///< m2
  Color total_reflectance() const { return reflectance * transmittance; }  ///< Of the diffuse part, under the coat.
};

/// A straight line that cuts a cell of a plane primitive, or a part of it, where another surface stands on it or
/// crosses it.
struct Cut {
  Vec2d from{0.0}, to{0.0};  ///< On the line, in the primitive's PlaneFrame, m.
  /// What lies to its left and to its right: another cut, ~patch, or kNothing outside of a region.
  std::array<std::int32_t, 2> sides{0, 0};
  static constexpr std::int32_t kNothing = std::numeric_limits<std::int32_t>::min();
};

/// A file that the scene was read from. Its content is part of the import's key.
struct SourceFile {
  std::string path;  ///< Relative to the folder of the scene file.
  std::string hash;
};

/// The content of patches.h5. Patches of one primitive are contiguous: first one of each cell of its grid, in rows of
/// growing v, with growing u within a row, where every row spans u from 0 to 1; then the other parts of cut cells, with
/// the (u,v) range of their cell. Cells outside of a region have no patch. A cluster of facets is one patch. Primitives
/// have the order of their patches.
struct PatchSet {
  /// Number of cells of the environment; 0 without one.
  int sky_cells() const { return environment ? int(environment->cells.size()) : 0; }

  std::vector<Patch> patches;
  std::vector<Cut> cuts;
  std::vector<Primitive> primitives;
  std::vector<Material> materials;
  std::vector<std::string> nodes;
  std::vector<std::int32_t> unseen;  ///< By node: whether cameras do not see its surfaces; empty: they see all.
  std::vector<std::string> light_groups;
  std::vector<Light> lights;
  std::vector<LightDistribution> distributions;
  std::optional<Environment> environment;
  std::vector<Camera> cameras;
  std::vector<SourceFile> sources;
  std::vector<Shader> shaders;
  std::vector<Texture> textures;
  std::vector<Texture> masks;                   ///< Alpha masks; texels are alpha in [0,255].
  std::vector<Texcoords> texcoords;             ///< [primitives]; empty: texture coordinates are the primitives' (u,v).
  std::vector<Texcoords> emission_texcoords{};  ///< For emission textures; empty: `texcoords`.
  std::vector<Texcoords> metallic_roughness_texcoords{};  ///< For these textures; empty: `texcoords`.
  std::vector<Texcoords> normal_texcoords{};              ///< For normal textures; empty: `texcoords`.
  std::vector<CornerColors> colors;                       ///< [primitives] Vertex colours; empty: none.
  std::vector<CornerNormals> normals{};                   ///< [primitives]; empty: all are flat.

  std::string inputs_key;    ///< Hash of the scene files and import settings.
  std::string key;           ///< Hash of the input of the solver. Set by the file layer.
  std::string geometry_key;  ///< Hash of the input of form factors: shapes and mirrors. Set by the file layer.
  std::string frames_key;    ///< Hash of data that only the tracer reads, without cameras. Set by the file layer.
  Provenance made;
};

/// Whether textures or vertex colours vary the reflectance of primitive `i`.
inline bool is_colored(const PatchSet& scene, std::int32_t i) {
  const Primitive& primitive = scene.primitives[i];
  return primitive.texture >= 0 || primitive.metallic_roughness_texture >= 0 ||
         (!scene.colors.empty() && scene.colors[i] != kWhiteVertices);
}

/// Whether a material reflects other than diffusely.
inline bool is_specular(const Material& material) {
  return material.specular != Color(0.0f) || material.is_coated();
}

/// Whether a part of the light that falls on a primitive leaves its other side diffusely.
inline bool is_translucent(const PatchSet& scene, const Primitive& primitive) {
  return primitive.back >= 0 && scene.materials[primitive.material].translucence != Color(0.0f);
}

/// Whether light passes a primitive: glass, or a surface that covers places in part.
inline bool lets_light_pass(const PatchSet& scene, const Primitive& primitive) {
  const Material& material = scene.materials[primitive.material];
  return material.transmission.exists() || (primitive.mask >= 0 && material.alpha_cutoff == 0.0f);
}

/// Whether any material has a coat.
inline bool has_coats(const std::vector<Material>& materials) {
  return std::any_of(materials.begin(), materials.end(), [](const Material& m) { return m.is_coated(); });
}

/// Whether textures or vertex colours vary the specular reflectance of primitive `i`.
inline bool has_varying_metal(const PatchSet& scene, std::int32_t i) {
  return is_colored(scene, i) && scene.materials[scene.primitives[i].material].metal != Color(0.0f);
}

/// Whether a texture varies the coat of primitive `i`.
inline bool has_varying_coat(const PatchSet& scene, std::int32_t i) {
  return scene.primitives[i].metallic_roughness_texture >= 0 &&
         scene.materials[scene.primitives[i].material].coat.exists();
}

/// Whether primitives are facets of clusters. Shape: [primitives].
std::vector<bool> facets_of_clusters(const PatchSet& scene);

/// The position of a quad at (u,v).
Vec3d position_at(const std::array<Vec3d, 4>& corners, double u, double v);

/// The axis-aligned box about all primitives, m; empty without any.
Imath::Box3d bounds_of(const std::vector<Primitive>& primitives);

}  // namespace patchlight

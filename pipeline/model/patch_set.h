#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/model/camera.h"
#include "pipeline/model/environment.h"
#include "pipeline/model/light.h"
#include "pipeline/model/math.h"
#include "pipeline/model/provenance.h"
#include "pipeline/model/shader.h"
#include "pipeline/model/texture.h"

namespace patchlight {

/// A surface that patches are cut from: a bilinear quad or a sphere.
///
/// Quad: p(u,v) is the bilinear mean of corners 0 (0,0), 1 (1,0), 2 (1,1), 3 (0,1); a triangle repeats its last corner.
/// Its lit side is the one from which the corners run counter-clockwise.
/// Sphere: u is the azimuth about world Y (0 at +X, growing towards -Z), v the polar angle from +Y, both in [0,1].
struct Primitive {
  enum class Shape : std::int32_t { quad = 0, sphere = 1 };

  Shape shape = Shape::quad;
  std::int32_t shader = -1;            ///< Index into PatchSet::shaders; -1: none.
  std::int32_t texture = -1;           ///< Of base colour: index into PatchSet::textures; -1: none.
  std::int32_t emission_texture = -1;  ///< The same.
  std::int32_t metallic_roughness_texture =
      -1;                  ///< The same; its green is roughness, its blue how metallic, both linear.
  std::int32_t mask = -1;  ///< Index into PatchSet::masks; -1: it is whole.
  std::array<Vec3d, 4> corners{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};  ///< m; zeros for a sphere.
  Vec3d sphere_center{0.0};                                                      ///< m; zero for a quad.
  double sphere_radius = 0.0;     ///< m; negative: lit inside. Zero for a quad.
  std::int32_t node = 0;          ///< Index into PatchSet::nodes.
  std::int32_t material = 0;      ///< Index into PatchSet::materials.
  std::int32_t light_group = -1;  ///< Index into PatchSet::light_groups; -1 for what does not emit.
  std::int32_t back = -1;         ///< The primitive that is this surface's other side, its u mirrored; -1: none.
  /// Corners with the same id meet smoothly, without a crease or border; every corner of a sphere is -1.
  std::array<std::int32_t, 4> smooth_vertices{-1, -1, -1, -1};

  bool is_triangle() const { return shape == Shape::quad && corners[2] == corners[3]; }
};

/// What is the same over a whole material.
struct Material {
  std::string name;
  Color specular{0.0f};    ///< Mirror reflectance (the metallic part), each in [0,1]; the mean where textures vary it.
  float roughness = 1.0f;  ///< The same.
  Color tint{1.0f};        ///< Diffuse reflectance is this times the colours of texture and vertices, if any.
  float alpha = 1.0f;      ///< A masked primitive is there where this times the mask and the vertices' alpha
  float alpha_cutoff = 0.0f;  ///< is no less than this.
  Color metal{0.0f};          ///< Where textures or vertices vary it, `specular` is this times base colour and finish.
  float roughness_factor = 1.0f;  ///< What a texture's roughness is multiplied by.
  Color emission_tint{0.0f};      ///< Radiant exitance where an emission texture is white, W/m2.
};

/// The (u,v) that shaders and textures see at corners 0 to 3 of a primitive, and bilinear between them.
using Texcoords = std::array<Vec2f, 4>;
inline const Texcoords kOwnTexcoords{Vec2f(0, 0), Vec2f(1, 0), Vec2f(1, 1), Vec2f(0, 1)};

/// Linear colours and alpha of the vertices at corners 0 to 3 of a primitive, and bilinear between them.
using CornerColors = std::array<Vec4f, 4>;
inline const CornerColors kUncolored{Vec4f(1.0f), Vec4f(1.0f), Vec4f(1.0f), Vec4f(1.0f)};

/// A piece of a primitive, the unit that the solution is constant on.
struct Patch {
  Vec3d center{0.0};        ///< m, world space: the surface point at the middle of (u,v).
  Vec3f normal{0.0f};       ///< Unit vector out of the lit side.
  double area = 0.0;        ///< m2, true surface area.
  Color reflectance{0.0f};  ///< Diffuse, each in [0,1).
  Color emission{0.0f};     ///< Radiant exitance, W/m2.
  std::int32_t primitive = 0;
  float u0 = 0, v0 = 0, u1 = 1, v1 = 1;
  /// Part of the area that is there, the rest being cut out. Reflectance, emission and irradiance are of what is there.
  float coverage = 1.0f;

  double covered_area() const { return area * double(coverage); }  ///< m2
};

/// A file that the scene was read from: what it holds is part of the import's key.
struct SourceFile {
  std::string path;  ///< Relative to the scene file's folder.
  std::string hash;
};

/// The content of patches.h5. Patches of one primitive are contiguous, in rows of growing v, growing u within a row;
/// every row spans u from 0 to 1. Primitives stand in the order of their patches.
struct PatchSet {
  /// Cells of the environment; 0 without one.
  int sky_cells() const { return environment ? int(environment->cells.size()) : 0; }

  std::vector<Patch> patches;
  std::vector<Primitive> primitives;
  std::vector<Material> materials;
  std::vector<std::string> nodes;
  std::vector<std::string> light_groups;
  std::vector<Light> lights;
  std::optional<Environment> environment;
  std::vector<Camera> cameras;
  std::vector<SourceFile> sources;
  std::vector<Shader> shaders;
  std::vector<Texture> textures;
  std::vector<Texture> masks;        ///< Their texels are alpha, in [0,255].
  std::vector<Texcoords> texcoords;  ///< By primitive; empty where shaders and textures see the primitive's own (u,v).
  std::vector<Texcoords> emission_texcoords{};            ///< Those that emission textures see; empty: `texcoords`.
  std::vector<Texcoords> metallic_roughness_texcoords{};  ///< Those that finish textures see; empty: `texcoords`.
  std::vector<CornerColors> colors;  ///< By primitive; empty where no vertex has a colour that counts.

  std::string inputs_key;    ///< Scene files and import settings that this was made from.
  std::string key;           ///< What solving reads. Set by the file layer.
  std::string geometry_key;  ///< What form factors depend on: shapes and mirrors. Set by the file layer.
  std::string frames_key;    ///< What only frames read, cameras apart. Set by the file layer.
  Provenance made;
};

/// Whether textures or vertices' colours say what primitive `i` reflects.
inline bool is_colored(const PatchSet& scene, std::int32_t i) {
  const Primitive& primitive = scene.primitives[i];
  return primitive.texture >= 0 || primitive.metallic_roughness_texture >= 0 ||
         (!scene.colors.empty() && scene.colors[i] != kUncolored);
}

/// The same of what it reflects as a metal.
inline bool has_varied_metal(const PatchSet& scene, std::int32_t i) {
  return is_colored(scene, i) && scene.materials[scene.primitives[i].material].metal != Color(0.0f);
}

}  // namespace patchlight

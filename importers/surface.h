#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight {

/// Where on its texture a surface's points are: KHR_texture_transform of one of the mesh's sets of coordinates.
struct TextureMapping {
  int set = 0;  ///< TEXCOORD_0, TEXCOORD_1, ...
  Vec2f offset{0.0f, 0.0f};
  Vec2f scale{1.0f, 1.0f};
  float rotation = 0.0f;  ///< rad, counter-clockwise where v grows downwards.

  Vec2f operator()(const Vec2f& uv) const;
};

/// What light does at a surface.
struct SurfaceMaterial {
  std::string name;
  Color reflectance{0.0f};  ///< Diffuse.
  Color specular{0.0f};     ///< Of the metallic part.
  float roughness = 1.0f;   ///< Of the metallic part.
  Color emission{0.0f};     ///< Radiant exitance, W/m2.
  bool double_sided = false;
  std::int32_t texture = -1;    ///< Of the reflectance, among the scene's; -1: none.
  TextureMapping mapping;       ///< Onto that texture.
  Color tint{1.0f};             ///< What the texture is multiplied by; `reflectance` is the mean.
  bool overridden = false;      ///< The job says what the reflectance is, whatever vertices say.
  std::string light_group;      ///< As the file, or the job, names it; empty: not named.
  bool group_from_job = false;  ///< It counts before what a node of the file says.
  double patch_area = 0.0;      ///< m2; 0: the scene's.

  bool emits() const { return emission != Color(0.0f); }
};

/// Triangles in the world, three corners each, counter-clockwise from the lit side.
struct TriangleSoup {
  std::vector<Vec3d> positions;    ///< m. Shape: [3 triangles].
  std::vector<Vec3f> normals;      ///< Unit, of the file. Shape: [3 triangles]; zero where the file has none.
  std::vector<Vec2f> texcoords;    ///< Shape: [3 triangles], NaN where the file has none; empty where none are wanted.
  double rounding = 0.0;           ///< m; how far off the numbers that the file holds places may be.
  bool quantized = false;          ///< Places are integers, or were.
  double texcoord_rounding = 0.0;  ///< The same of texture coordinates, beyond a float's.
  std::vector<Vec3f> colors;       ///< Linear. Shape: [3 triangles], ones where the file has none; empty without any.
};

/// A planar piece of a mesh: a convex quad, or a triangle that repeats its last corner.
struct Facet {
  std::array<Vec3d, 4> corners{};
  std::array<std::int32_t, 4> smooth_vertices{};
  std::array<Vec2f, 4> texcoords{};  ///< Set where the soup has them.
  std::array<Vec3f, 4> colors{};     ///< Set where the soup has them.
};

/// A sphere that a mesh stands for.
struct Sphere {
  Vec3d center{0.0};
  double radius = 0.0;  ///< m; negative: lit inside.
};

}  // namespace patchlight

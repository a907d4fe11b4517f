#pragma once
#include <algorithm>
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

  bool operator==(const TextureMapping&) const = default;

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
  std::int32_t texture = -1;           ///< Of the reflectance, among the scene's; -1: none.
  TextureMapping mapping;              ///< Onto that texture, and the mask.
  Color tint{1.0f};                    ///< What the texture is multiplied by; `reflectance` is the mean.
  std::int32_t emission_texture = -1;  ///< Among the scene's; -1: none.
  TextureMapping emission_mapping{};
  Color emission_tint{0.0f};                     ///< What that texture is multiplied by, W/m2; `emission` is the mean.
  std::int32_t metallic_roughness_texture = -1;  ///< Among the scene's; -1: none.
  TextureMapping metallic_roughness_mapping{};
  float texture_metallic = 1.0f;  ///< The mean of what that texture says of how metallic it is.
  float roughness_factor = 1.0f;  ///< What that texture's roughness is multiplied by; `roughness` is the mean.
  Color metal{0.0f};          ///< What base colour times that texture's metal is multiplied by; `specular` the mean.
  bool overridden = false;    ///< The job says what the reflectance is, whatever vertices say.
  std::int32_t mask = -1;     ///< Of its cut-outs, among the scene's; -1: none.
  float alpha = 1.0f;         ///< What that mask is multiplied by,
  float alpha_cutoff = 0.0f;  ///< and what it has to come to where something is there.
  bool mask_of_vertices = false;  ///< Without alpha of vertices nothing is cut out.
  bool invisible = false;         ///< Its alpha is too low everywhere.
  std::string light_group;        ///< As the file, or the job, names it; empty: not named.
  bool group_from_job = false;    ///< It counts before what a node of the file says.
  double patch_area = 0.0;        ///< m2; 0: the scene's.

  /// The textures' mappings, each once; the first is `mapping`, which shaders see too.
  struct Mappings {
    std::vector<TextureMapping> all;
    std::size_t emission = 0, metallic_roughness = 0;  ///< Which of them those textures lie by.
  };
  Mappings mappings() const {
    Mappings result{{mapping}};
    const auto number = [&](std::int32_t image, const TextureMapping& of) {
      if (image < 0) return std::size_t{0};
      const auto found = std::find(result.all.begin(), result.all.end(), of);
      const auto at = static_cast<std::size_t>(found - result.all.begin());
      if (found == result.all.end()) result.all.push_back(of);
      return at;
    };
    result.emission = number(emission_texture, emission_mapping);
    result.metallic_roughness = number(metallic_roughness_texture, metallic_roughness_mapping);
    return result;
  }
  bool has_texture() const { return texture >= 0 || emission_texture >= 0 || metallic_roughness_texture >= 0; }
  bool emits() const { return emission != Color(0.0f); }
};

/// Triangles in the world, three corners each, counter-clockwise from the lit side.
struct TriangleSoup {
  std::vector<Vec3d> positions;  ///< m. Shape: [3 triangles].
  std::vector<Vec3f> normals;    ///< Unit, of the file. Shape: [3 triangles]; zero where the file has none.
  /// By mapping: shape [3 triangles], NaN where the file has none. Empty where none are wanted.
  std::vector<std::vector<Vec2f>> texcoords;
  double rounding = 0.0;           ///< m; how far off the numbers that the file holds places may be.
  bool quantized = false;          ///< Places are integers, or were.
  double texcoord_rounding = 0.0;  ///< The same of texture coordinates, beyond a float's.
  std::vector<Vec4f>
      colors;  ///< Linear, and alpha. Shape: [3 triangles], ones where the file has none; empty without any.
};

/// Where a facet's corner takes texture coordinates and colours from: a corner of the mesh, or the way from it to
/// another.
struct CornerSource {
  std::int32_t from = 0, to = 0;  ///< Numbers of corners, three for each triangle of the mesh.
  double part = 0.0;              ///< Of the way.

  template <class Value>
  Value operator()(const std::vector<Value>& values) const {
    const Value& a = values[static_cast<std::size_t>(from)];
    if (part == 0.0) return a;
    return Value(a + (values[static_cast<std::size_t>(to)] - a) * static_cast<typename Value::BaseType>(part));
  }
};

/// A planar piece of a mesh: a convex quad, or a triangle that repeats its last corner.
struct Facet {
  std::array<Vec3d, 4> corners{};
  std::array<std::int32_t, 4> smooth_vertices{};
  std::array<CornerSource, 4> sources{};
};

/// A sphere that a mesh stands for.
struct Sphere {
  Vec3d center{0.0};
  double radius = 0.0;  ///< m; negative: lit inside.
};

}  // namespace patchlight

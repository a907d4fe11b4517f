#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/model/math.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// A texture coordinate set and its KHR_texture_transform.
struct TextureMapping {
  int set = 0;  ///< N of TEXCOORD_N.
  Vec2f offset{0.0f, 0.0f};
  Vec2f scale{1.0f, 1.0f};
  float rotation = 0.0f;  ///< rad, counter-clockwise with v pointing down.

  bool operator==(const TextureMapping&) const = default;

  Vec2f operator()(const Vec2f& uv) const;
};

/// A glTF material with the job's overrides applied.
struct SurfaceMaterial {
  std::string name;
  Color reflectance{0.0f};  ///< Diffuse.
  Color specular{0.0f};     ///< Of the metallic part.
  float roughness = 1.0f;   ///< Of the metallic part and of the coat.
  Coat coat{};
  Transmission transmission{};
  Color translucence{0.0f};  ///< As Material has it.
  ClearCoat clear_coat{};
  Color emission{0.0f};  ///< Radiant exitance, W/m2.
  bool double_sided = false;
  std::int32_t texture = -1;           ///< Base colour texture, among the scene's; -1: none.
  TextureMapping mapping;              ///< Of that texture and of the mask.
  Color tint{1.0f};                    ///< Factor of the base colour texture's diffuse part; `reflectance` is the mean.
  std::int32_t emission_texture = -1;  ///< Among the scene's textures; -1: none.
  TextureMapping emission_mapping{};
  Color emission_tint{0.0f};                     ///< Factor of the emission texture, W/m2; `emission` is the mean.
  std::int32_t metallic_roughness_texture = -1;  ///< Among the scene's textures; -1: none.
  TextureMapping metallic_roughness_mapping{};
  std::int32_t normal_texture = -1;  ///< Among the scene's textures; -1: none.
  TextureMapping normal_mapping{};
  float normal_scale = 1.0f;
  float mean_metallic = 1.0f;     ///< Mean of the metallic channel of that texture.
  float roughness_factor = 1.0f;  ///< Factor of that texture's roughness channel; `roughness` is the mean.
  Color metal{0.0f};              ///< Factor of base colour texture times metallic channel; `specular` is the mean.
  bool reflectance_overridden = false;   ///< By the job: vertex colours are ignored.
  std::int32_t mask = -1;                ///< Alpha mask, among the scene's masks; -1: none.
  float alpha = 1.0f;                    ///< Factor of the mask's alpha.
  float alpha_cutoff = 0.0f;             ///< The alpha test passes where alpha is not less.
  bool masked_by_vertices_only = false;  ///< The texture's alpha passes the test everywhere; vertex alpha may not.
  bool has_uniform_mask = false;         ///< The texture's alpha is the same everywhere.
  bool invisible = false;                ///< The alpha test fails everywhere.
  std::string light_group;               ///< From the file or the job; empty: none.
  bool light_group_from_job = false;     ///< Then it takes precedence over the light group of a node.
  double patch_area = 0.0;               ///< m2; 0: that of the scene.

  /// The textures' mappings without duplicates. The first is `mapping`, which shaders use too.
  struct Mappings {
    std::vector<TextureMapping> all;
    std::size_t emission = 0, metallic_roughness = 0, normal = 0;  ///< Indices into `all` of what these textures use.
  };
  Mappings mappings() const {
    Mappings result{{mapping}};
    const auto index_of = [&](std::int32_t texture_index, const TextureMapping& used) {
      if (texture_index < 0) return std::size_t{0};
      const auto found = std::find(result.all.begin(), result.all.end(), used);
      const auto index = static_cast<std::size_t>(found - result.all.begin());
      if (found == result.all.end()) result.all.push_back(used);
      return index;
    };
    result.emission = index_of(emission_texture, emission_mapping);
    result.metallic_roughness = index_of(metallic_roughness_texture, metallic_roughness_mapping);
    result.normal = index_of(normal_texture, normal_mapping);
    return result;
  }
  bool has_texture() const {
    return texture >= 0 || emission_texture >= 0 || metallic_roughness_texture >= 0 || normal_texture >= 0;
  }
  bool emits() const { return emission != Color(0.0f); }
  /// Whether its surfaces have two sides with patches. That of a body of glass has one, and lets light out; one that
  /// passes light to its other side has both.
  bool has_two_sides() const { return (double_sided || translucence != Color(0.0f)) && !transmission.solid; }
};

/// Unconnected triangles in world space, three corners each, counter-clockwise seen from the front.
struct TriangleSoup {
  std::vector<Vec3d> positions;      ///< m. Shape: [3 triangles].
  std::vector<Vec3f> normals;        ///< Unit, from the file. Shape: [3 triangles]; zero where the file has none.
  std::int64_t invalid_normals = 0;  ///< Of the file, far from unit length; zero in `normals`.
  /// By mapping. Shape: [3 triangles] each, NaN where the file has none. Empty if none are requested.
  std::vector<std::vector<Vec2f>> texcoords;
  double rounding = 0.0;           ///< m; error of positions due to their number format in the file.
  bool quantized = false;          ///< Positions come from integers.
  double texcoord_rounding = 0.0;  ///< Error of quantized texture coordinates; 0 for floats.
  /// Linear RGB and alpha. Shape: [3 triangles], ones where the file has none; empty if none are requested.
  std::vector<Vec4f> colors;
};

/// The corner after one, around its triangle.
constexpr std::size_t next_corner(std::size_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

/// Source of a facet corner's texture coordinates and colours: linear interpolation between two corners of the mesh, or
/// the affine continuation of three.
struct CornerSource {
  std::int32_t from = 0, to = 0;  ///< Indices of corners, 3 per triangle of the mesh.
  double fraction = 0.0;          ///< 0: `from`, 1: `to`.
  std::int32_t third = 0;         ///< A corner that counts if its fraction is not 0.
  double third_fraction = 0.0;

  template <class Value>
  Value operator()(const std::vector<Value>& values) const {
    const Value& a = values[static_cast<std::size_t>(from)];
    using Scalar = typename Value::BaseType;
    Value result = a;
    if (fraction != 0.0) result += (values[static_cast<std::size_t>(to)] - a) * static_cast<Scalar>(fraction);
    if (third_fraction != 0.0)
      result += (values[static_cast<std::size_t>(third)] - a) * static_cast<Scalar>(third_fraction);
    return result;
  }
};

/// A planar piece of a mesh: a convex quad, a triangle that repeats its last corner, or a region of a rectangle.
struct Facet {
  std::array<Vec3d, 4> corners{};
  std::array<std::int32_t, 4> smooth_vertices{};
  std::array<CornerSource, 4> sources{};
  std::shared_ptr<const Region> region{};  ///< Null: all of the quad.
};

/// A sphere that a mesh approximates.
struct Sphere {
  Vec3d center{0.0};
  double radius = 0.0;  ///< m; negative: faces inward.
};

}  // namespace patchlight

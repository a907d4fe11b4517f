#include "pipeline/formats/patches/patch_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/formats/patches/patch_clusters.h"
#include "pipeline/formats/patches/patch_cuts.h"
#include "pipeline/formats/patches/patch_materials.h"
#include "pipeline/formats/patches/patch_regions.h"
#include "pipeline/job/expression.h"

namespace patchlight {

namespace {

template <class Vector>
bool finite(const Vector& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool within(const Color& c, float low, float high) {
  for (int k = 0; k < 3; ++k)
    if (!(c[k] >= low && c[k] <= high)) return false;
  return true;
}

bool index_of(std::int64_t index, std::size_t size) {
  return index >= 0 && index < std::int64_t(size);
}

constexpr double kMaxDistance = 1e12;  // m; beyond, positions lose precision and areas overflow
bool near(const Vec3d& v) {
  return std::abs(v.x) <= kMaxDistance && std::abs(v.y) <= kMaxDistance &&
         std::abs(v.z) <= kMaxDistance;  // false for NaN
}

/// Only a triangle's last edge may have length 0, and every surface must have an area.
bool has_extent(const Primitive& quad) {
  const auto& c = quad.corners;
  const double area = ((c[2] - c[0]) % (c[3] - c[1])).length();
  return c[0] != c[1] && c[1] != c[2] && c[3] != c[0] && area > 0 && std::isfinite(area);
}

bool smooth_vertices_fit(const Primitive& p) {
  const auto& ids = p.smooth_vertices;
  const bool none = std::all_of(ids.begin(), ids.end(), [](std::int32_t id) { return id == -1; });
  if (none || p.shape == Primitive::Shape::sphere) return none;
  return std::all_of(ids.begin(), ids.end(), [](std::int32_t id) { return id >= 0; }) &&
         (!p.is_triangle() || ids[2] == ids[3]);
}

PatchFault primitive_fault(const PatchSet& scene, std::size_t i) {
  const Primitive& p = scene.primitives[i];
  for (const auto& corner : p.corners)
    if (!near(corner)) return {"a corner that is not finite or too far away", "/primitives/corners"};
  const bool sphere = p.shape == Primitive::Shape::sphere;
  if (!near(p.sphere_center) || !(std::abs(p.sphere_radius) <= kMaxDistance) || sphere != (p.sphere_radius != 0))
    return {"a sphere without a centre or radius", "/primitives/sphere"};
  if (!sphere && !has_extent(p)) return {"a quad without extent", "/primitives/corners"};
  if (!index_of(p.material, scene.materials.size())) return {"an index out of range", "/primitives/material"};
  if (!index_of(p.node, scene.nodes.size())) return {"an index out of range", "/primitives/node"};
  if (p.light_group != -1 && !index_of(p.light_group, scene.light_groups.size()))
    return {"an index out of range", "/primitives/light_group"};
  if (p.back != -1 && (!index_of(p.back, scene.primitives.size()) || p.back == std::int32_t(i) ||
                       scene.primitives[p.back].back != std::int32_t(i) || scene.primitives[p.back].shape != p.shape))
    return {"two sides that do not name each other", "/primitives/back"};
  if (!smooth_vertices_fit(p)) return {"indices that do not fit the surface", "/primitives/smooth_vertices"};
  return {};
}

PatchFault expression_fault(const ColorExpressions& color, const char* where) {
  if (color == ColorExpressions{}) return {};
  for (const std::string& text : color) {
    try {
      const Expression expression(text);
    } catch (const ExpressionFault& fault) {
      return {"an expression that does not compile: " + fault.reason, where};
    }
  }
  return {};
}

PatchFault shader_fault(const PatchSet& scene) {
  for (const Shader& shader : scene.shaders) {
    if (PatchFault fault = expression_fault(shader.reflectance, "/shaders/reflectance")) return fault;
    if (PatchFault fault = expression_fault(shader.emission, "/shaders/emission")) return fault;
  }
  return {};
}

/// Checks what a primitive refers to.
PatchFault reference_fault(const PatchSet& scene, const Primitive& p) {
  if (p.shader != -1 && !index_of(p.shader, scene.shaders.size()))
    return {"an index out of range", "/primitives/shader"};
  const bool emits = p.emission_texture != -1 || (p.shader != -1 && is_set(scene.shaders[p.shader].emission));
  if (emits && p.light_group < 0) return {"an emitter without a light group", "/primitives/light_group"};
  const auto is_there = [&](std::int32_t texture, const std::vector<Texcoords>& texcoords) {
    return texture == -1 ||
           (index_of(texture, scene.textures.size()) && (!texcoords.empty() || !scene.texcoords.empty()));
  };
  if (!is_there(p.texture, scene.texcoords)) return {"an index out of range", "/primitives/texture"};
  if (!is_there(p.emission_texture, scene.emission_texcoords))
    return {"an index out of range", "/primitives/emission_texture"};
  if (!is_there(p.metallic_roughness_texture, scene.metallic_roughness_texcoords))
    return {"an index out of range", "/primitives/finish_texture"};
  if (!is_there(p.normal_texture, scene.normal_texcoords))
    return {"an index out of range", "/primitives/normal_texture"};
  if (p.mask != -1 && (!index_of(p.mask, scene.masks.size()) || p.shape != Primitive::Shape::quad))
    return {"a mask that is not there, or of no quad", "/primitives/mask"};
  if (p.back >= 0 && scene.primitives[p.back].mask != p.mask)
    return {"two sides with different masks", "/primitives/mask"};
  return {};
}

PatchFault texcoord_fault(const PatchSet& scene, const std::vector<Texcoords>& texcoords, const char* where) {
  if (!texcoords.empty() && texcoords.size() != scene.primitives.size())
    return {"another number than of primitives", where};
  for (const Texcoords& corners : texcoords)
    for (const Vec2f& corner : corners)
      if (!std::isfinite(corner.x) || !std::isfinite(corner.y))
        return {"a texture coordinate that is not finite", where};
  return {};
}

PatchFault texture_fault(const PatchSet& scene) {
  if (PatchFault fault = texcoord_fault(scene, scene.texcoords, "/primitives/texcoord")) return fault;
  if (PatchFault fault = texcoord_fault(scene, scene.emission_texcoords, "/primitives/emission_texcoord")) return fault;
  if (PatchFault fault = texcoord_fault(scene, scene.normal_texcoords, "/primitives/normal_texcoord")) return fault;
  return texcoord_fault(scene, scene.metallic_roughness_texcoords, "/primitives/finish_texcoord");
}

PatchFault mask_fault(const PatchSet& scene) {
  for (const Texture& mask : scene.masks)
    for (const std::int32_t alpha : mask.texels)
      if (alpha < 0 || alpha > 255) return {"a value outside [0, 255]", "/masks/texel"};
  for (const Material& m : scene.materials)
    if (!(m.alpha >= 0 && m.alpha <= 1 && std::isfinite(m.alpha_cutoff)))
      return {"a value that is not finite", "/materials/alpha"};
  if (!scene.colors.empty() && scene.colors.size() != scene.primitives.size())
    return {"another number than of primitives", "/primitives/color"};
  for (const CornerColors& corners : scene.colors)
    for (const Vec4f& c : corners)
      for (int k = 0; k < 4; ++k)
        if (!(c[k] >= 0 && c[k] <= 1)) return {"a value outside [0, 1]", "/primitives/color"};
  return {};
}

PatchFault patch_fault(const PatchSet& scene, const Patch& patch) {
  if (!finite(patch.center)) return {"a centre that is not finite", "/patches/center"};
  if (!finite(patch.normal) || std::abs(patch.normal.length() - 1.0f) > 1e-3f)
    return {"a normal that is not a unit vector", "/patches/normal"};
  if (!(patch.area > 0 && std::isfinite(patch.area))) return {"an area that is not positive", "/patches/area"};
  if (!within(patch.reflectance, 0.0f, 0.99999f)) return {"a value outside [0, 1)", "/patches/reflectance"};
  const Color& passed = scene.materials[scene.primitives[patch.primitive].material].translucence;
  if (!within(patch.reflectance + passed, 0.0f, 1.00001f))
    return {"more than 1 with what passes", "/materials/translucence"};
  if (!within(patch.transmittance, 0.0f, 1.0f)) return {"a value outside [0, 1]", "/patches/coat_transmittance"};
  if (!within(patch.emission, 0.0f, 3e38f)) return {"a negative or non-finite value", "/patches/emission"};
  if (!(patch.coverage > 0 && patch.coverage <= 1)) return {"a value outside (0, 1]", "/patches/coverage"};
  if (patch.emission != Color(0.0f) && scene.primitives[patch.primitive].light_group < 0)
    return {"an emitter without a light group", "/primitives/light_group"};
  return {};
}

/// Whether a float is boundary `i` of `count` equal parts of [0,1], up to rounding.
bool is_boundary(float x, std::size_t i, std::size_t count) {
  constexpr double kRounding = 1.0 / (1 << 24);
  return std::abs(double(x) - double(i) / double(count)) <= kRounding;
}

/// Numbers of patches in the rows that tile primitive `index`, from patch `next` on; empty if they do not tile it.
/// Advances `next` to the first patch after them.
std::vector<std::size_t> rows_of(const PatchSet& scene, std::size_t index, std::size_t& next) {
  std::vector<std::size_t> rows;
  for (float v = 0; v != 1;) {
    float u = 0;
    const float v1 = next < scene.patches.size() ? scene.patches[next].v1 : 0;
    if (!(v1 > v && v1 <= 1)) return {};
    rows.push_back(0);
    for (; u != 1; ++next, ++rows.back()) {
      if (next == scene.patches.size()) return {};
      const Patch& patch = scene.patches[next];
      if (patch.primitive != std::int32_t(index) || patch.u0 != u || patch.v0 != v || patch.v1 != v1) return {};
      if (!(patch.u1 > u && patch.u1 <= 1)) return {};
      u = patch.u1;
    }
    v = v1;
  }
  return rows;
}

/// Whether rows have equal heights, patches of a row equal widths, and rows of a quad equal numbers of patches.
bool is_even(const PatchSet& scene, const Primitive& primitive, const std::vector<std::size_t>& rows,
             std::size_t patch) {
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (primitive.shape == Primitive::Shape::quad && rows[row] != rows[0]) return false;
    for (std::size_t i = 0; i < rows[row]; ++i, ++patch)
      if (!is_boundary(scene.patches[patch].u1, i + 1, rows[row]) ||
          !is_boundary(scene.patches[patch].v1, row + 1, rows.size()))
        return false;
  }
  return true;
}

void skip_further_parts(const PatchSet& scene, std::size_t index, std::size_t& next) {
  while (next < scene.patches.size() && scene.patches[next].primitive == std::int32_t(index) &&
         scene.patches[next].cut >= 0)
    ++next;
}

/// The number of cells along an edge, of which [low, high] is one; 0: none is.
std::int64_t cells_along(float low, float high) {
  constexpr double kMostCells = 1 << 22;
  const double count = std::round(1.0 / (double(high) - low));
  return count >= 1 && count <= kMostCells ? std::int64_t(count) : 0;
}

/// Whether patches from `next` on are cells of an even grid on region `index`, in their order. Advances `next` to the
/// first patch after them, and takes the grid's cells from `most`.
bool are_cells_of_region(const PatchSet& scene, std::size_t index, std::size_t& next, std::int64_t& most) {
  if (next == scene.patches.size()) return false;
  const Patch& first = scene.patches[next];
  const std::int64_t columns = cells_along(first.u0, first.u1), rows = cells_along(first.v0, first.v1);
  most -= columns * rows;
  if (columns == 0 || rows == 0 || most < 0) return false;
  for (std::int64_t last = -1; next < scene.patches.size(); ++next) {
    const Patch& patch = scene.patches[next];
    if (patch.primitive != std::int32_t(index)) break;
    if (!(patch.u0 >= 0 && patch.u1 <= 1 && patch.v0 >= 0 && patch.v1 <= 1)) return false;  // NaN too
    const std::int64_t column = std::llround(patch.u0 * double(columns)), row = std::llround(patch.v0 * double(rows));
    if (!is_boundary(patch.u0, std::size_t(column), std::size_t(columns)) ||
        !is_boundary(patch.u1, std::size_t(column) + 1, std::size_t(columns)) ||
        !is_boundary(patch.v0, std::size_t(row), std::size_t(rows)) ||
        !is_boundary(patch.v1, std::size_t(row) + 1, std::size_t(rows)))
      return false;
    if (row * columns + column <= last && patch.cut >= 0) break;  // a further part of a cut cell
    if (row * columns + column <= last) return false;
    last = row * columns + column;
  }
  return next > 0 && scene.patches[next - 1].primitive == std::int32_t(index);
}

/// Checks that the patches of each primitive are rows that tile the unit square evenly.
PatchFault order_fault(const PatchSet& scene) {
  std::size_t next = 0;
  std::int64_t region_cells = Region::kMostCells;
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    const std::size_t first = next;
    if (next < scene.patches.size() && scene.patches[next].facets > 0 &&
        scene.patches[next].primitive == std::int32_t(i)) {
      i += std::size_t(scene.patches[next++].facets) - 1;
      continue;
    }
    if (scene.primitives[i].region) {
      if (!are_cells_of_region(scene, i, next, region_cells))
        return {"patches that are not cells of their region", "/patches/uv"};
      skip_further_parts(scene, i, next);
      continue;
    }
    const std::vector<std::size_t> rows = rows_of(scene, i, next);
    if (rows.empty()) return {"patches that do not tile their primitive", "/patches/uv"};
    if (!is_even(scene, scene.primitives[i], rows, first)) return {"patches of uneven size", "/patches/uv"};
    skip_further_parts(scene, i, next);
  }
  if (next != scene.patches.size()) return {"patches that do not tile their primitive", "/patches/uv"};
  return {};
}

}  // namespace

PatchFault find_fault(const PatchSet& scene) {
  if (scene.patches.empty()) return {"no patches", "/patches/area"};
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    if (PatchFault fault = primitive_fault(scene, i)) return fault;
    if (PatchFault fault = reference_fault(scene, scene.primitives[i])) return fault;
  }
  if (PatchFault fault = shader_fault(scene)) return fault;
  if (PatchFault fault = texture_fault(scene)) return fault;
  if (PatchFault fault = mask_fault(scene)) return fault;
  for (const Patch& patch : scene.patches) {
    if (!index_of(patch.primitive, scene.primitives.size())) return {"an index out of range", "/patches/primitive"};
    if (PatchFault fault = patch_fault(scene, patch)) return fault;
  }
  for (const Material& m : scene.materials)
    if (!is_valid(m)) return {"a value out of range", "/materials"};
  for (const Camera& camera : scene.cameras)
    for (const double* x = &camera.to_world.x[0][0]; x != &camera.to_world.x[0][0] + 16; ++x)
      if (!std::isfinite(*x) || !(camera.vertical > 0 && std::isfinite(camera.vertical)))
        return {"a camera that is not finite", "/cameras"};
  for (const Camera& camera : scene.cameras)
    if (!lens_fault(camera).empty()) return {"a camera's lens that cannot be", "/cameras"};
  if (scene.cameras.empty()) return {"no camera", "/cameras/name"};
  if (PatchFault fault = order_fault(scene)) return fault;
  if (PatchFault fault = cluster_fault(scene)) return fault;
  if (PatchFault fault = region_fault(scene)) return fault;
  return cut_fault(scene);
}

}  // namespace patchlight

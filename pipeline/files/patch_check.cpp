#include "pipeline/files/patch_check.h"

#include <cmath>

#include "pipeline/files/expression.h"

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

PatchFault primitive_fault(const PatchSet& scene, std::size_t i) {
  const Primitive& p = scene.primitives[i];
  for (const auto& corner : p.corners)
    if (!finite(corner)) return {"a corner that is not finite", "/primitives/corners"};
  const bool sphere = p.shape == Primitive::Shape::sphere;
  if (!finite(p.sphere_center) || !std::isfinite(p.sphere_radius) || sphere != (p.sphere_radius != 0))
    return {"a sphere without a centre or radius", "/primitives/sphere"};
  if (!index_of(p.material, scene.materials.size())) return {"an index out of range", "/primitives/material"};
  if (!index_of(p.node, scene.nodes.size())) return {"an index out of range", "/primitives/node"};
  if (p.light_group != -1 && !index_of(p.light_group, scene.light_groups.size()))
    return {"an index out of range", "/primitives/light_group"};
  if (p.back != -1 && (!index_of(p.back, scene.primitives.size()) || p.back == std::int32_t(i) ||
                       scene.primitives[p.back].back != std::int32_t(i) || scene.primitives[p.back].shape != p.shape))
    return {"two sides that do not name each other", "/primitives/back"};
  for (const std::int32_t vertex : p.smooth_vertices)
    if (vertex < -1) return {"a negative index", "/primitives/smooth_vertices"};
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
  for (const Primitive& p : scene.primitives) {
    if (p.shader == -1) continue;
    if (!index_of(p.shader, scene.shaders.size())) return {"an index out of range", "/primitives/shader"};
    if (is_set(scene.shaders[p.shader].emission) && p.light_group < 0)
      return {"an emitter without a light group", "/primitives/light_group"};
  }
  if (!scene.texcoords.empty() && scene.texcoords.size() != scene.primitives.size())
    return {"another number than of primitives", "/primitives/texcoord"};
  for (const Texcoords& corners : scene.texcoords)
    for (const Vec2f& corner : corners)
      if (!std::isfinite(corner.x) || !std::isfinite(corner.y))
        return {"a texture coordinate that is not finite", "/primitives/texcoord"};
  return {};
}

PatchFault patch_fault(const PatchSet& scene, const Patch& patch) {
  if (!finite(patch.center)) return {"a centre that is not finite", "/patches/center"};
  if (!finite(patch.normal) || std::abs(patch.normal.length() - 1.0f) > 1e-3f)
    return {"a normal that is not a unit vector", "/patches/normal"};
  if (!(patch.area > 0 && std::isfinite(patch.area))) return {"an area that is not positive", "/patches/area"};
  if (!within(patch.reflectance, 0.0f, 0.99999f)) return {"a value outside [0, 1)", "/patches/reflectance"};
  if (!within(patch.emission, 0.0f, 3e38f)) return {"a negative or non-finite value", "/patches/emission"};
  if (patch.emission != Color(0.0f) && scene.primitives[patch.primitive].light_group < 0)
    return {"an emitter without a light group", "/primitives/light_group"};
  return {};
}

/// Patches of a primitive are rows that tile the unit square.
PatchFault order_fault(const PatchSet& scene) {
  const PatchFault fault{"patches that do not tile their primitive", "/patches/uv"};
  std::size_t next = 0;
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    for (float v = 0; v != 1;) {
      float u = 0;
      const float v1 = next < scene.patches.size() ? scene.patches[next].v1 : 0;
      if (!(v1 > v && v1 <= 1)) return fault;
      for (; u != 1; ++next) {
        if (next == scene.patches.size()) return fault;
        const Patch& patch = scene.patches[next];
        if (patch.primitive != std::int32_t(i) || patch.u0 != u || patch.v0 != v || patch.v1 != v1) return fault;
        if (!(patch.u1 > u && patch.u1 <= 1)) return fault;
        u = patch.u1;
      }
      v = v1;
    }
  }
  return next == scene.patches.size() ? PatchFault{} : fault;
}

}  // namespace

PatchFault find_fault(const PatchSet& scene) {
  if (scene.patches.empty()) return {"no patches", "/patches/area"};
  for (std::size_t i = 0; i < scene.primitives.size(); ++i)
    if (PatchFault fault = primitive_fault(scene, i)) return fault;
  if (PatchFault fault = shader_fault(scene)) return fault;
  for (const Patch& patch : scene.patches) {
    if (!index_of(patch.primitive, scene.primitives.size())) return {"an index out of range", "/patches/primitive"};
    if (PatchFault fault = patch_fault(scene, patch)) return fault;
  }
  for (const Material& m : scene.materials)
    if (!within(m.specular, 0.0f, 1.0f) || !(m.roughness >= 0 && m.roughness <= 1))
      return {"a value outside [0, 1]", "/materials"};
  for (const Camera& camera : scene.cameras)
    for (const double* x = &camera.to_world.x[0][0]; x != &camera.to_world.x[0][0] + 16; ++x)
      if (!std::isfinite(*x) || !(camera.vertical > 0 && std::isfinite(camera.vertical)))
        return {"a camera that is not finite", "/cameras"};
  if (scene.cameras.empty()) return {"no camera", "/cameras/name"};
  return order_fault(scene);
}

}  // namespace patchlight

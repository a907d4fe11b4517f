#include "solver/display/display_faces.h"

#include <algorithm>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/surface/material_shader.h"
#include "pipeline/optics/surface/texture_lookup.h"
#include "pipeline/optics/transport/elements.h"
#include "pipeline/optics/transport/face_lookup.h"
#include "solver/form_factors/row_scattering.h"

namespace patchlight {

SpectrumField face_reflectance(const PatchSet& scene, const DisplayMesh& mesh) {
  constexpr int kAcross = 4;
  std::vector<MaterialShader> shaders = compile_shaders(scene);
  const std::vector<Patch> parts = face_patches(scene, mesh);
  SpectrumField reflectance;
  for (std::size_t f = 0; f < parts.size(); ++f) {
    const Patch& part = parts[f];
    const Primitive& primitive = scene.primitives[part.primitive];
    Spectrum& mean = reflectance.emplace_back(part.reflectance);
    const bool shaded = primitive.shader >= 0 && shaders[primitive.shader].reflects();
    if (mesh.faces[f].part == 1.0f || (!shaded && !is_colored(scene, part.primitive))) continue;
    const PatchSampler sampler(scene.primitives, part);
    Spectrum sum;
    int count = 0;
    for (int k = 0; k < kAcross * kAcross; ++k) {
      const Imath::V2d at =
          sampler.place((float(k % kAcross) + 0.5f) / float(kAcross), (float(k / kAcross) + 0.5f) / float(kAcross)).uv;
      if (primitive.mask >= 0 && !passes_alpha_test(scene, part.primitive, at.x, at.y)) continue;
      ++count;
      sum += Spectrum(shaded ? shaded_reflectance(scene, shaders[primitive.shader], part.primitive, at.x, at.y)
                             : colored_reflectance(scene, part.primitive, at.x, at.y));
    }
    if (count > 0) mean = sum * Spectrum(1.0 / count);
  }
  return reflectance;
}

std::vector<Scattering::Passage> face_passages(const PatchSet& scene, const DisplayMesh& mesh) {
  std::vector<Scattering::Passage> passages;
  if (std::ranges::none_of(scene.primitives, [&](const Primitive& p) { return is_translucent(scene, p); }))
    return passages;
  const Elements elements(scene, mesh);
  const std::vector<Patch> parts = face_patches(scene, mesh);
  for (std::int32_t f = 0; f < mesh.elements(); ++f) {
    const Primitive& primitive = scene.primitives[parts[f].primitive];
    if (!is_translucent(scene, primitive)) continue;
    const auto [front, uv] = PatchSampler(scene.primitives, parts[f]).place(0.5f, 0.5f);
    if (scene.primitives[front].back < 0) continue;
    const std::int32_t behind = elements.at(scene.primitives[front].back, 1.0f - float(uv.x), float(uv.y));
    const Color& translucence = scene.materials[primitive.material].translucence;
    passages.push_back({f, behind, seen_by_rows(scene, scene.patches[mesh.faces[f].patch], translucence, true)});
  }
  return passages;
}

std::vector<float> exposure_of_vertices(const Transport::Display& display) {
  constexpr float kExposed = 0.25f;
  const TransportRows& rows = display.rows;
  std::vector<float> exposure(display.mesh.vertices.size(), 1.0f);
  for (std::int32_t i = 0; i < display.mesh.gathered; ++i) {
    float sum = 0;
    for (int k = 2 * i; k < 2 * i + 2; ++k) {
      sum += float(rows.starts[k + 1] - rows.starts[k]) * rows.hit_weights[k];
      if (!rows.sky_weights.empty()) sum += float(rows.sky_starts[k + 1] - rows.sky_starts[k]) * rows.sky_weights[k];
    }
    exposure[i] = std::min(1.0f, 0.5f * sum / kExposed);
  }
  const std::size_t first = display.mesh.vertices.size() - display.mesh.midpoints.size();
  for (std::size_t k = 0; k < display.mesh.midpoints.size(); ++k)
    exposure[first + k] = 0.5f * (exposure[display.mesh.midpoints[k][0]] + exposure[display.mesh.midpoints[k][1]]);
  return exposure;
}

}  // namespace patchlight

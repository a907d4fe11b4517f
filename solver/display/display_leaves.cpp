#include "solver/display/display_leaves.h"

#include <algorithm>

#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/surface/material_shader.h"
#include "pipeline/optics/surface/texture_lookup.h"
#include "pipeline/optics/transport/elements.h"

namespace patchlight {

SpectrumField leaf_reflectance(const PatchSet& scene, const DisplayMesh& mesh, const LeafElements& leaves) {
  constexpr int kAcross = 4;
  std::vector<MaterialShader> shaders = compile_shaders(scene);
  SpectrumField reflectance(mesh.elements);
  leaves.for_each([&](std::size_t patch, std::int32_t element, auto, float) {
    reflectance[element] = Spectrum(scene.patches[patch].reflectance);
  });
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    const Patch& patch = scene.patches[i];
    const Primitive& primitive = scene.primitives[patch.primitive];
    const bool shaded = primitive.shader >= 0 && shaders[primitive.shader].reflects();
    const bool divided =
        mesh.roots[i] >= 0 && (mesh.cells[mesh.roots[i]].children >= 0 || mesh.cells[mesh.roots[i]].cut);
    if (!divided || (!shaded && !is_colored(scene, patch.primitive))) continue;
    for_each_leaf(scene, mesh, i, [&](std::int32_t element, const Patch& leaf) {
      const PatchSampler sampler(primitive, leaf);
      const int across = leaf.u0 == leaf.u1 ? 1 : kAcross;  // a corner has no size
      Spectrum sum;
      int count = 0;
      for (int k = 0; k < across * across; ++k) {
        const Imath::V2d at =
            sampler.uv((float(k % across) + 0.5f) / float(across), (float(k / across) + 0.5f) / float(across));
        if (primitive.mask >= 0 && !passes_alpha_test(scene, patch.primitive, at.x, at.y)) continue;
        ++count;
        sum += Spectrum(shaded ? shaded_reflectance(scene, shaders[primitive.shader], patch.primitive, at.x, at.y)
                               : colored_reflectance(scene, patch.primitive, at.x, at.y));
      }
      if (count > 0) reflectance[element] = sum * Spectrum(1.0 / count);
    });
  }
  return reflectance;
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

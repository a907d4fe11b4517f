#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/model/display_mesh.h"
#include "solver/linear/spectrum.h"

namespace patchlight {

/// Smooths sampled irradiance over the gathering vertices of the display mesh where that reduces the mean squared
/// error.
///
/// A step replaces the value of a vertex by that of a plane fitted to it and the vertices with which it shares faces,
/// so no step reaches through what stands on a surface. Filters of growing width are S = 2 F^k - F^2k for k steps F
/// ("twicing": Tukey 1977), which keep gradients and most of the curvature. Each vertex has its own filter, or none:
/// two independent sample sets tell which (error_increase()).
class VertexFilter {
 public:
  VertexFilter(const PatchSet& scene, const DisplayMesh& mesh);

  /// Filters `irradiance` [gathered] by its `deviation`, half the difference of its sample sets.
  SpectrumField apply(const SpectrumField& irradiance, const SpectrumField& deviation) const;

 private:
  /// F of a field.
  SpectrumField step(const SpectrumField& field) const;
  /// The medians of neighbours' means over the vertices around them, hardly with a vertex's own value: so a single
  /// steep place counts little. Only where `wanted`; else 0.
  std::vector<double> pooled(std::vector<double> values, const std::vector<bool>& wanted) const;

  std::vector<std::uint32_t> starts_;  ///< [gathered + 1] Of rows: a vertex, then those with which it shares faces.
  std::vector<std::int32_t> near_;
  std::vector<float> weights_;  ///< Of F.
};

}  // namespace patchlight

#include "solver/error/consistency.h"

#include <algorithm>
#include <cmath>

#include "solver/form_factors/coated_rows.h"

namespace patchlight {

namespace {

/// Row sums of all patches; zeros where no rows were cast, as in a scene without light.
SpectrumField padded_row_sums(std::size_t patches, const FormFactorRows& rows) {
  SpectrumField sums = rows.row_sums();
  sums.resize(patches);
  return sums;
}

constexpr double kLeastLanding = 1e-6;  // part of the rays that end on a surface

}  // namespace

std::vector<double> visible_areas(const PatchSet& scene, const Transport& transport) {
  std::vector<double> areas;
  for (std::size_t i = 0; i < scene.patches.size(); ++i) {
    const Patch& patch = scene.patches[i];
    const Primitive& primitive = scene.primitives[patch.primitive];
    const bool by_chance = transport.rays > 0 && passes_by_chance(scene, primitive);
    const double landing =
        by_chance ? Spectrum(patch.transmittance).sum() / 3 * double(untransmitted_part(scene, primitive)) : 1.0;
    areas.push_back(patch.covered_area() * std::max(landing, kLeastLanding) *
                    (transport.visible_fractions.empty()
                         ? 1.0
                         : 0.5 * (transport.visible_fractions[2 * i] + transport.visible_fractions[2 * i + 1])));
  }
  return areas;
}

std::vector<double> receiving_areas(const PatchSet& scene, std::vector<double> areas) {
  for (std::size_t i = 0; i < areas.size(); ++i)
    if (scene.primitives[scene.patches[i].primitive].intangible) areas[i] = 0;
  return areas;
}

double reciprocity_error(const Transport& transport, const FormFactorRows& rows, const std::vector<double>& areas) {
  const std::size_t n = areas.size();
  std::vector<double> column_sums(n);
  const auto is_patch = [&](std::uint64_t at) { return std::size_t(transport.columns[at]) < n; };
  for (std::size_t k = 0; k + 1 < transport.starts.size(); ++k) {
    const std::uint64_t begin = transport.starts[k], end = transport.starts[k + 1];
    const double area = 0.5 * areas[k / 2];
    if (transport.rays > 0) {
      const double weight = area * double(transport.hit_weights[k]);
      for (std::uint64_t at = begin; at < end; ++at)
        if (is_patch(at)) column_sums[transport.columns[at]] += weight;
    } else {
      for (std::uint64_t at = begin; at < end; ++at)
        if (is_patch(at)) column_sums[transport.columns[at]] += area * double(transport.weights[at]);
    }
  }
  for (const auto& m : transport.mirrored)
    if (std::size_t(m.patch) < n) column_sums[m.patch] += 0.5 * areas[m.row] * Spectrum(m.weight).sum() / 3;
  const SpectrumField row_sums = padded_row_sums(n, rows);
  double square = 0, norm = 0;
  for (std::size_t j = 0; j < n; ++j) {
    if (areas[j] == 0) continue;
    const double row_sum = areas[j] * row_sums[j].sum() / 3;
    square += (column_sums[j] - row_sum) * (column_sums[j] - row_sum) / areas[j];
    norm += row_sum * row_sum / areas[j];
  }
  return norm > 0 ? std::sqrt(square / norm) : 0.0;
}

EnergyBalance::EnergyBalance(const PatchSet& scene, const FormFactorRows& rows, const std::vector<double>& areas,
                             const Scattering& scattering, SpectrumField external_irradiance,
                             const SpectrumField& irradiance, const CoatExchange& coats)
    : areas_(receiving_areas(scene, areas)),
      reflectance_(scattering.albedo),
      row_sums_(padded_row_sums(areas.size(), rows)) {
  const SpectrumField exitance = scattering.exitance(irradiance);
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const Spectrum area(areas_[i]);
    Spectrum reflected = exitance[i];
    if (!coats.reflected.empty()) {
      reflected += coats.reflected[i];
      excess_ -= coats.unmatched[i] * area;
    }
    const Spectrum emitted = Spectrum(scene.patches[i].emission) * Spectrum(areas[i]);
    emitted_ += emitted + external_irradiance[i] * area;
    excess_ += emitted * row_sums_[i] + (reflected * row_sums_[i] + external_irradiance[i] - irradiance[i]) * area;
  }
}

double EnergyBalance::error() const {
  double worst = 0;
  for (int k = 0; k < 3; ++k)
    if (emitted_.c[k] > 0) worst = std::max(worst, std::abs(excess_.c[k]) / emitted_.c[k]);
  return worst;
}

Spectrum EnergyBalance::missing_power(const SpectrumField& missing) const {
  Spectrum power = excess_;
  for (std::size_t i = 0; i < areas_.size(); ++i)
    power += (reflectance_[i] * row_sums_[i] * missing[i] - missing[i]) * Spectrum(areas_[i]);
  return power;
}

}  // namespace patchlight

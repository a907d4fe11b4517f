#include "solver/error/consistency.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

/// What each patch sees of all others; nothing where no rows were cast, as in a scene without light.
SpectrumField seen_by(std::size_t patches, const FormFactorRows& rows) {
  SpectrumField seen = rows.seen();
  seen.resize(patches);
  return seen;
}

}  // namespace

std::vector<double> visible_areas(const PatchSet& scene, const Transport& transport) {
  std::vector<double> areas;
  for (std::size_t i = 0; i < scene.patches.size(); ++i)
    areas.push_back(scene.patches[i].covered_area() *
                    (transport.visible_fractions.empty()
                         ? 1.0
                         : 0.5 * (transport.visible_fractions[2 * i] + transport.visible_fractions[2 * i + 1])));
  return areas;
}

double reciprocity_error(const Transport& transport, const FormFactorRows& rows, const std::vector<double>& areas) {
  const std::size_t n = areas.size();
  std::vector<double> seen_of(n);
  const auto is_patch = [&](std::uint64_t at) { return std::size_t(transport.columns[at]) < n; };
  for (std::size_t k = 0; k + 1 < transport.starts.size(); ++k) {
    const std::uint64_t begin = transport.starts[k], end = transport.starts[k + 1];
    const double area = 0.5 * areas[k / 2];
    if (transport.rays > 0) {
      const double share = area * double(transport.hit_weights[k]);
      for (std::uint64_t at = begin; at < end; ++at)
        if (is_patch(at)) seen_of[transport.columns[at]] += share;
    } else {
      for (std::uint64_t at = begin; at < end; ++at)
        if (is_patch(at)) seen_of[transport.columns[at]] += area * double(transport.weights[at]);
    }
  }
  for (const auto& m : transport.mirrored)
    if (std::size_t(m.patch) < n) seen_of[m.patch] += 0.5 * areas[m.row] * Spectrum(m.weight).sum() / 3;
  const SpectrumField seen = seen_by(n, rows);
  double square = 0, norm = 0;
  for (std::size_t j = 0; j < n; ++j) {
    const double sees = areas[j] * seen[j].sum() / 3;
    square += (seen_of[j] - sees) * (seen_of[j] - sees) / areas[j];
    norm += sees * sees / areas[j];
  }
  return norm > 0 ? std::sqrt(square / norm) : 0.0;
}

double balance_error(const FormFactorRows& rows, const std::vector<double>& areas, const SpectrumField& reflectance,
                     const SpectrumField& emission, const SpectrumField& from_outside,
                     const SpectrumField& irradiance) {
  const SpectrumField seen = seen_by(areas.size(), rows);
  Spectrum emitted, left;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const Spectrum area(areas[i]), reflected = reflectance[i] * irradiance[i];
    emitted += (emission[i] + from_outside[i]) * area;
    left += ((emission[i] + reflected) * seen[i] + from_outside[i] - irradiance[i]) * area;
  }
  double worst = 0;
  for (int k = 0; k < 3; ++k)
    if (emitted.c[k] > 0) worst = std::max(worst, std::abs(left.c[k]) / emitted.c[k]);
  return worst;
}

}  // namespace patchlight

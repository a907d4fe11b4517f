#pragma once
#include "pipeline/model/energy_field.h"
#include "pipeline/model/transport.h"
#include "pipeline/optics/transport/elements.h"

namespace patchlight::test {

/// A scene with each patch cut into four, and the patch that each was cut from.
struct FinerPatches {
  PatchSet scene;
  std::vector<std::size_t> parents;

  explicit FinerPatches(const PatchSet& coarse) : scene(coarse) {
    scene.patches.clear();
    for (std::size_t first = 0, end = 0; first < coarse.patches.size(); first = end) {
      const auto is_in_row = [&](const Patch& p) {
        return p.primitive == coarse.patches[first].primitive && p.v0 == coarse.patches[first].v0;
      };
      while (end < coarse.patches.size() && is_in_row(coarse.patches[end])) ++end;
      for (std::size_t half = 0; half < 2; ++half)
        for (std::size_t i = first; i < end; ++i) {
          const std::array<Patch, 4> parts = quarters(coarse, coarse.patches[i]);
          for (std::size_t k = 0; k < 2; ++k) {
            scene.patches.push_back(parts[2 * half + k]);
            parents.push_back(i);
          }
        }
    }
  }

  /// A solution on the fine patches, averaged over the coarse ones, as other patches see them.
  EnergyField averaged(const EnergyField& fine, const Transport& transport, std::size_t coarse) const {
    EnergyField result;
    std::vector<double> weights(coarse);
    const auto weight = [&](std::size_t j) {
      const auto& visible = transport.visible_fractions;
      return scene.patches[j].covered_area() * (visible.empty() ? 1.0 : double(visible[2 * j]));
    };
    for (std::size_t j = 0; j < parents.size(); ++j) weights[parents[j]] += weight(j);
    for (const EnergyField::Group& group : fine.groups) {
      EnergyField::Group& mean = result.groups.emplace_back();
      mean.direct.assign(coarse, Color(0.0f));
      mean.indirect.assign(coarse, Color(0.0f));
      for (std::size_t j = 0; j < parents.size(); ++j) {
        const auto part = float(weight(j) / weights[parents[j]]);
        mean.direct[parents[j]] += group.direct[j] * part;
        mean.indirect[parents[j]] += group.indirect[j] * part;
      }
    }
    return result;
  }
};

}  // namespace patchlight::test

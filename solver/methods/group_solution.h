#pragma once
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/model/transport.h"
#include "pipeline/optics/lights/direct_light.h"
#include "pipeline/stage/progress.h"
#include "solver/direct/coat_light.h"
#include "solver/error/consistency.h"
#include "solver/linear/linear_system.h"

namespace patchlight {

/// The linear system that all light groups share.
struct RadiositySystem {
  const PatchSet& scene;
  const Transport& transport;
  const FormFactorRows rows;
  const std::vector<Emitter> emitters;  ///< As in `transport`.
  const std::vector<Emitter> further;   ///< See further_emitters().
  std::vector<double> areas;            ///< [n] Covered area, m2.
  Scattering scattering;                ///< [n] See row_scattering().
  const CoatLight coat_light;

  RadiositySystem(const PatchSet& patches, const Transport& from);
};

/// Unfiltered irradiance of one light group, W/m2, by component, and deviations: half the difference between the sample
/// sets. Shape of each field: [n], or empty where the group has no such light.
struct GroupSolution {
  SpectrumField explicit_direct;  ///< Direct light of explicitly sampled emitters.
  SpectrumField gathered_direct;  ///< Direct light of the other emitters and the environment.
  SpectrumField sampled_direct;   ///< Direct light of emitters that a LightTree chose.
  SpectrumField mirrored;         ///< Light of emitters by specular reflection.
  SpectrumField over_metals;      ///< The part of `mirrored` from explicitly sampled emitters.
  CoatExchange coats;
  SpectrumField reflected;  ///< Light that patches reflect diffusely.
  SpectrumField explicit_deviation, gathered_deviation, sampled_deviation, mirrored_deviation, reflected_deviation;
  SpectrumField residual;             ///< What is left of the linear system: F rho (D + H) - H of the solved H.
  SpectrumField external_irradiance;  ///< The light of lights and the environment, which no patch emits.
  bool has_sky = false;               ///< Whether gathered_direct has light of the environment.
  LinearSolve linear;

  void resize_mirrored(std::size_t patches) {
    mirrored.resize(patches);
    mirrored_deviation.resize(patches);
  }

  /// `factor_at`: of the sample sets 0 and 1 of patch i at 2 i and 2 i + 1.
  template <class FactorAt>
  void add_external(const Spectrum& strength, std::size_t patches, FactorAt factor_at) {
    external_irradiance.resize(patches);
    for (std::size_t i = 0; i < patches; ++i)
      external_irradiance[i] +=
          strength * (Spectrum(factor_at(2 * i)) + Spectrum(factor_at(2 * i + 1))) * Spectrum(0.5);
  }
};

/// Solves for the irradiance of all light groups of the scene. Throws: Error (interrupted).
std::vector<GroupSolution> solve_groups(const RadiositySystem& system, double tolerance, Progress& progress);

}  // namespace patchlight

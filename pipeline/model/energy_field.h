#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/model/display_mesh.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// The content of energy.h5: the irradiance that each light group causes on every patch, at the scene's own strength.
struct EnergyField {
  struct Group {
    std::string name;
    std::vector<Color> direct;    ///< [n] W/m2, straight from the group's emitters.
    std::vector<Color> indirect;  ///< [n] W/m2, after at least one reflection.
    /// [n] W/m2, the part of `direct` whose emitters no one samples apart (see DirectLight); empty: none.
    std::vector<Color> gathered_direct{};
    /// [display->gathered] W/m2, at the display mesh's vertices: `indirect` and `gathered_direct`.
    std::vector<Color> display{};
    /// [n] W/m2, the part of `indirect` that photons brought from emitters sampled apart, by way of mirrors. It is for
    /// the display solution, and not in energy.h5. Empty: none; rows tell it where they follow mirrors.
    std::vector<Color> by_photons{};
  };

  /// What a solve says of its own error.
  struct Estimate {
    double error = 0.0;        ///< Expected radiosity_error() against the true solution on the same patches.
    double error_bound = 0.0;  ///< What it stays below in 19 of 20 solves.
    double balance = 0.0;      ///< Emitted power that is neither absorbed by patches nor escaped, over emitted power.
    double reciprocity = 0.0;  ///< Area-weighted relative L2 of column sums, A_i F_ij summed over i, against A_j.
    std::vector<Color> deviation;  ///< [n] W/m2, standard error of the radiosity. Rough: two halves tell it.
  };

  /// How a solve came nearer: its residual before each iteration and after the last.
  struct Convergence {
    std::string group;              ///< Empty: of all groups together.
    std::vector<double> residuals;  ///< Of `progressive`, whose batches of shots are many, some of them.
  };

  std::vector<Group> groups;  ///< In the order of PatchSet::light_groups.
  std::string key;
  std::string patches_key;  ///< Key of the patch file that was solved.
  std::string method;
  std::string form_factors;
  std::int64_t iterations = 0;
  std::int64_t rays = 0;  ///< Cast by this solve.
  double seconds = 0.0;   ///< Wall time of the solve.
  double residual = 0.0;  ///< Area-weighted L2 norm of what is left of the linear system over that of its source term.
  std::vector<Convergence> convergence;
  std::optional<Estimate> estimate;
  std::optional<DisplayMesh> display;
  Provenance made;
};

/// Irradiance of all groups, direct and indirect, each multiplied by its setting, W/m2. Shape: [patches].
std::vector<Color> irradiance(const EnergyField& energy, const std::vector<Color>& settings, std::size_t patches);

/// What one group causes, direct and indirect, W/m2. Shape: [patches].
std::vector<Color> irradiance(const EnergyField::Group& group);

/// The same without what comes straight from emitters that are sampled apart.
std::vector<Color> irradiance_without_explicit(const EnergyField::Group& group);

/// Radiosity B = E + rho * (all groups' direct + indirect irradiance), W/m2. Shape: [patches].
std::vector<Color> radiosity(const PatchSet& scene, const EnergyField& energy);

/// Area-weighted relative L2 difference of reflected radiosity, B - E, over patches that do not emit: an emitter's own
/// B would hide the rest. Both solutions are of `scene`. 0 if they are equal, infinite if only the truth is black.
double radiosity_error(const PatchSet& scene, const EnergyField& energy, const EnergyField& truth);

}  // namespace patchlight

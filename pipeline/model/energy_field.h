#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/model/patch_set.h"

namespace patchlight {

/// The content of energy.h5: the irradiance that each light group causes on every patch, at the scene's own strength.
struct EnergyField {
  struct Group {
    std::string name;
    std::vector<Color> direct;    ///< [n] W/m2, straight from the group's emitters.
    std::vector<Color> indirect;  ///< [n] W/m2, after at least one reflection.
    /// [n] W/m2, the part of `direct` whose emitters no one samples apart (see DirectLight); empty: none.
    std::vector<Color> direct_by_rows{};
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
};

/// Irradiance of all groups, direct and indirect, each multiplied by its setting, W/m2. Shape: [patches].
std::vector<Color> irradiance(const EnergyField& energy, const std::vector<Color>& settings, std::size_t patches);

/// Radiosity B = E + rho * (all groups' direct + indirect irradiance), W/m2. Shape: [patches].
std::vector<Color> radiosity(const PatchSet& scene, const EnergyField& energy);

/// Area-weighted relative L2 difference of reflected radiosity, B - E, over patches that do not emit: an emitter's own
/// B would hide the rest. Both solutions are of `scene`. 0 if they are equal, infinite if only the truth is black.
double radiosity_error(const PatchSet& scene, const EnergyField& energy, const EnergyField& truth);

}  // namespace patchlight

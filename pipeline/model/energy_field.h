#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/model/display_mesh.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// The content of energy.h5: the irradiance on every patch from each light group, at the strength in the scene file.
struct EnergyField {
  struct Group {
    std::string name;
    std::vector<Color> direct;    ///< [patches] W/m2, from the group's emitters without reflection.
    std::vector<Color> indirect;  ///< [patches] W/m2, after at least one reflection.
    /// [patches] W/m2, the part of `direct` from the environment and from emitters that are gathered with the form
    /// factors instead of sampled (see explicit_emitters() and further_emitters()); empty: none.
    std::vector<Color> gathered_direct{};
    /// [display->gathered] W/m2, `indirect` + `gathered_direct` at the display mesh's gathered vertices.
    std::vector<Color> display{};
    /// [patches] W/m2, the part of `direct` from further_emitters(). For the display solution; not stored in energy.h5.
    /// Empty: none.
    std::vector<Color> sampled_direct{};
    /// [patches] W/m2, the part of `indirect` from explicitly sampled emitters over metals alone. For the display
    /// solution; not stored in energy.h5. Empty: none, or the rows of form factors contain it.
    std::vector<Color> over_metals{};
    /// [patches] W/m2, what coats reflect of sampled emitters' direct light, as exitance. For the display solution; not
    /// stored in energy.h5. Empty: no coats, or the method ignores them.
    std::vector<Color> by_coats{};
  };

  /// A solve's estimate of its own error.
  struct Estimate {
    static constexpr double kUnknown = std::numeric_limits<double>::infinity();

    /// Expected radiosity_error() against the exact solution: of the same patches, or, with a display solution, of
    /// finer ones.
    double error = 0.0;
    double error_bound = 0.0;           ///< 95% upper bound of the error.
    double error_residual = 0.0;        ///< Part of `error` that the linear system's residual causes.
    double error_patches = 0.0;         ///< Part of `error` by patches that are too coarse; 0: not estimated.
    double error_local = kUnknown;      ///< 95% upper bound of the local_radiosity_error(); kUnknown in old files.
    double error_local_estimate = 0.0;  ///< Expected local_radiosity_error().
    double balance = 0.0;               ///< Emitted power minus absorbed and escaped power, over emitted power.
    double reciprocity = 0.0;           ///< Area-weighted relative L2 difference of sum_i A_i F_ij and A_j.
    std::vector<Color> deviation;       ///< [patches] W/m2, standard error of the radiosity, from two sample sets.
  };

  /// Residuals before each iteration and after the last.
  struct Convergence {
    std::string group;              ///< Light group; empty: all groups solved together.
    std::vector<double> residuals;  ///< Method `progressive` stores a selection.
  };

  std::vector<Group> groups;  ///< In the order of PatchSet::light_groups.
  std::string key;
  std::string patches_key;  ///< Key of the patches.h5 that was solved.
  std::string method;
  std::string form_factors;
  std::int64_t iterations = 0;
  std::int64_t rays = 0;  ///< Rays cast by this solve.
  double seconds = 0.0;   ///< Wall time of the solve.
  double residual = 0.0;  ///< Area-weighted L2 norm of the linear system's residual, over that of its source term.
  std::vector<Convergence> convergence;
  std::optional<Estimate> estimate;
  std::optional<DisplayMesh> display;
  Provenance made;
};

/// Direct and indirect irradiance of all groups, each multiplied by its entry of `settings`, W/m2. Shape: [patches].
std::vector<Color> irradiance(const EnergyField& energy, const std::vector<Color>& settings, std::size_t patches);

/// Direct and indirect irradiance of one group, W/m2. Shape: [patches].
std::vector<Color> irradiance(const EnergyField::Group& group);

/// The same without direct light from sampled emitters.
std::vector<Color> irradiance_without_sampled(const EnergyField::Group& group);

/// Radiosity B = E + rho * (all groups' direct + indirect irradiance), W/m2, without what passes translucent surfaces.
/// Shape: [patches].
std::vector<Color> radiosity(const PatchSet& scene, const EnergyField& energy);

/// Area-weighted relative L2 difference of reflected radiosity, B - E, over patches that do not emit: an emitter's
/// radiosity would hide the rest. Both solutions belong to `scene`. 0 if they are equal, infinite if only `reference`
/// is black.
double radiosity_error(const PatchSet& scene, const EnergyField& energy, const EnergyField& reference);

/// Smallest value that bounds the values of at least the part `level`, in [0,1], of the total weight; 0 without values.
/// `weighted`: pairs of a value and its weight.
double weighted_percentile(std::vector<std::pair<double, double>> weighted, double level);

/// Reflected radiosity below which a patch is black, over the root mean square of the scene's: rounding lights the
/// insides of closed bodies so much.
inline constexpr double kBlack = 1e-6;

/// Local error: the 95th percentile, by area, of the relative difference of reflected radiosity at a patch, over
/// patches that reflect and do not emit and are not black in both solutions. A bright place does not hide the error of
/// a dark one. Infinite where only `reference` is black.
double local_radiosity_error(const PatchSet& scene, const EnergyField& energy, const EnergyField& reference);

}  // namespace patchlight

#pragma once
#include <string>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/optics/sampling/patch_lookup.h"
#include "tracer/sampling/camera_rays.h"

namespace patchlight {

/// Finds surfaces that cameras see whose light is too uncertain: where the standard error that the solution states for
/// its patches exceeds a fifth of what they reflect.
class ErrorsInView {
 public:
  static constexpr double kMaxError = 0.2;  ///< Of the reflected radiosity of a patch.
  static constexpr double kMaxPart = 0.1;   ///< Of what cameras see of a surface, that may exceed it.

  /// `energy`: with an estimate. All arguments must outlive this object, but `energy`.
  ErrorsInView(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup, const EnergyField& energy);

  /// Adds what a camera sees.
  void add(const Camera& camera, double aspect);

  /// A warning that names the worst node, the number of others and what mends it; empty: none.
  std::string warning(const SolveConfig& config) const;

 private:
  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const PatchLookup& lookup_;
  std::vector<float> errors_;         ///< [patches] Relative; negative: it emits, or reflects nothing.
  std::vector<std::uint32_t> hits_;   ///< [patches] Number of rays of cameras.
  std::vector<std::string> cameras_;  ///< [nodes] The first that sees it.
};

}  // namespace patchlight

#pragma once
#include "pipeline/optics/lights/direct_light.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "solver/form_factors/visible_density.h"

namespace patchlight {

/// Mean over a patch of the unoccluded form factor to a light: weighted by its density of points if it has one (null:
/// none), else by Gauss-Legendre quadrature, the finer the nearer the light is.
double mean_form_factor(const DirectLight& light, const Patch& patch, const PatchSampler& sampler,
                        const VisibleDensity* density);

}  // namespace patchlight

#pragma once
#include <string>

#include "pipeline/job/job.h"

namespace patchlight {

/// Advice for users: the setting that brings a sampling error of the solve down by `factor`, with the square of that in
/// samples.
std::string more_samples(const SolveConfig& config, double factor);

}  // namespace patchlight

#pragma once
#include <string>
#include <vector>

#include "pipeline/job/job.h"
#include "pipeline/model/energy_field.h"

namespace patchlight {

/// Warnings of a solution that may be 5% off or whose energy balance is more than 1% off, with what mends it. With an
/// error target: of one that misses it because of its patches.
std::vector<std::string> error_warnings(const SolveConfig& config, const EnergyField::Estimate& estimate);

}  // namespace patchlight

#pragma once
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Gives the scene the job's environment, its light group, and as suns what of it is too bright and small for cells.
/// Nothing where it is black.
/// Throws: Error (missing_input) without the image; (bad_data) for an image that is none or holds what is negative or
/// not finite; (over_limit) for one too large.
void add_environment(const Job& job, PatchSet& scene, Progress& progress);

/// An image as radiance, reduced to `most_columns`, an even number, and half as many rows at most; for add_environment,
/// which loads it when it is first called. `place` names it for errors. Throws: Error (bad_data, over_limit).
extern "C" void decode_environment(const std::filesystem::path& file, const std::string& place, int most_columns,
                                   Environment& sky);

}  // namespace patchlight

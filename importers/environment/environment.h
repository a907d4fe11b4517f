#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Adds the job's environment and its light group to the scene. Small bright areas of the image become sun lights,
/// since cells are too coarse for them. A black environment is ignored, with a warning. Throws: Error (missing_input)
/// if the image does not exist; (bad_data) as decode_environment; (over_limit) if it is too large.
void add_environment(const Job& job, PatchSet& scene, Progress& progress);

/// Reads an image as radiance, averaged down to at most `max_columns` (even) x `max_columns` / 2 texels. Loaded from a
/// plugin by add_environment. Negative radiance down to -1% of the image's mean, as resampling and compression leave
/// it, counts as 0; `negative_texels` is the number of texels that have some. `place` names the image in errors.
/// Throws: Error (bad_data) for another format, for radiance below that and for values that are not finite;
/// (over_limit).
extern "C" void decode_environment(const std::filesystem::path& file, const std::string& place, int max_columns,
                                   Environment& sky, std::int64_t& negative_texels);

}  // namespace patchlight

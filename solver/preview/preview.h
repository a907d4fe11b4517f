#pragma once
#include <optional>
#include <string>

#include "pipeline/image/image_file.h"
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

struct PreviewOptions {
  std::string kind = "patches";       ///< patches | radiosity | irradiance | hemicube
  std::string camera;                 ///< Empty: the job's first.
  std::optional<std::int64_t> patch;  ///< The patch to highlight, or whose hemicube to draw.
};

/// Draws a diagnostic picture with OpenGL from patch ids, display-ready (sRGB, [0,1]):
/// patches: a colour for every patch, edges drawn, one patch highlighted;
/// radiosity: B / pi of every patch under the job's lights and exposure;
/// irradiance: false colours with a scale in W/m2;
/// hemicube: the five faces of a patch's hemicube, unfolded, a colour for every patch.
/// Reads the job's energy.h5 only for radiosity and irradiance.
/// Throws: Error (bad_config) for an unknown camera or patch; (unavailable) without OpenGL; and as read_energy.
Image draw_preview(const Job& job, const PatchSet& scene, const PreviewOptions& options);

}  // namespace patchlight

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
  std::optional<std::int64_t> patch;  ///< To highlight; for `hemicube`: whose faces.
};

/// A picture for understanding, drawn with OpenGL from patch ids, display-ready (sRGB, [0,1]):
/// patches: a colour for every patch, edges drawn, one patch highlighted;
/// radiosity: every patch in its one colour, B / pi under the job's lights and exposure;
/// irradiance: in false colour with a scale in W/m2;
/// hemicube: the five faces of a patch's hemicube, folded out, a colour for every patch.
/// The job's energy.h5 is read for radiosity and irradiance alone.
/// Throws: Error (bad_config) for an unknown camera or patch; (unavailable) without OpenGL; and what reading throws.
Image draw_preview(const Job& job, const PatchSet& scene, const PreviewOptions& options);

}  // namespace patchlight

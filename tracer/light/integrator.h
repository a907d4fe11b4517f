#pragma once
#include <optional>

#include "pipeline/image/image_file.h"
#include "pipeline/stage/progress.h"
#include "tracer/light/path_tracer.h"
#include "tracer/light/tile_light.h"
#include "tracer/sampling/camera_rays.h"

namespace patchlight {

/// How many samples the pixels of a frame get, as `trace.samples` says it for those in the middle.
struct SampleCounts {
  int few = 0;    ///< Where nothing changes from a pixel's neighbours to the others.
  int some = 0;   ///< At sharp shadows and where colours change.
  int edge = 0;   ///< Where edges pass.
  int first = 0;  ///< Those by which it is told which pixels are which.

  explicit SampleCounts(int samples);
  /// Every pixel gets as many, whatever is in it.
  bool even() const { return edge == first; }
};

/// Renders frames of one solved scene under one setting of its lights. Everything is shared between frames.
///
/// A pixel is the mean of its samples, all of the same weight. How many it has is told by the edges of the scene as
/// they are seen from the camera, by what its neighbours' first samples show, and by the shadows about it. Not by what
/// its own show: then what few of them meet would count for too little.
class Integrator {
 public:
  /// Throws: Error (bad_config) for a light group that the scene does not have.
  Integrator(const PatchSet& scene, const EnergyField& energy, const Job& job);

  /// Pixels are the same for any number of threads. Throws: Error (interrupted).
  Image render(const Camera& camera, Progress& progress) const;

 private:
  class Tile;

  const PatchSet& scene_;
  const TraceConfig& config_;
  const SampleCounts counts_;
  RayScene ray_scene_;
  Outlines outlines_;
  LightMixes mixes_;
  SolvedSurfaces surfaces_;
  PathTracer paths_;
  std::optional<PixelLight> lights_;  ///< With direct light at the pixel.
  std::optional<FinalGather> gather_;
};

}  // namespace patchlight

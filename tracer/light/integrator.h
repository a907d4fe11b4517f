#pragma once
#include <optional>

#include "pipeline/image/image_file.h"
#include "pipeline/stage/progress.h"
#include "tracer/light/lamps/tile_light.h"
#include "tracer/light/path_tracer.h"
#include "tracer/sampling/camera_rays.h"

namespace patchlight {

/// Samples for each pixel of a frame, by the detail around it. `trace.samples` sets `detail`.
struct SampleCounts {
  int smooth = 0;   ///< No detail among the pixel's neighbours.
  int detail = 0;   ///< At sharp shadows and where colours change.
  int edge = 0;     ///< Where edges pass.
  int initial = 0;  ///< Taken in every pixel first, to measure the detail.

  explicit SampleCounts(int samples);
  /// Whether all pixels take the same number of samples.
  bool uniform() const { return edge == initial; }
};

/// Renders frames of one solved scene. All members are shared between the frames of one setting of its lights.
///
/// A pixel is the unweighted mean of its samples. Their number depends on the edges of the scene in the image, on the
/// initial samples of the neighbouring pixels, and on shadow edges nearby, but not on the pixel's own samples: that
/// would give rare features too little weight.
class Integrator {
 public:
  /// With the lights of frame 1. Throws: Error (bad_config) for a light group that the scene does not have.
  Integrator(const PatchSet& scene, const EnergyField& energy, const Job& job);

  /// `settings`: factors of the light groups; see light_settings().
  void set_lights(const std::vector<Color>& settings);

  /// The pixels do not depend on the number of threads. Throws: Error (interrupted).
  Image render(const Camera& camera, Progress& progress) const;

  const RayScene& ray_scene() const { return ray_scene_; }
  const PatchLookup& patch_lookup() const { return surfaces_->lookup(); }

 private:
  class Tile;

  const PatchSet& scene_;
  const EnergyField& energy_;
  const TraceConfig& config_;
  const SampleCounts counts_;
  const SmoothEdges smooth_;
  RayScene ray_scene_;
  Outlines outlines_;
  std::vector<Color> settings_;  ///< Of the lights.
  std::optional<LightMixes> mixes_;
  std::optional<SolvedSurfaces> surfaces_;
  const bool direct_;                          ///< `quality` is not `patches`.
  std::optional<ExplicitLights> lights_;       ///< If direct_, or if the scene has rough metals.
  std::optional<FurtherLight> further_;        ///< The same.
  std::optional<GlossyLights> glossy_lights_;  ///< If the scene has rough metals.
  std::optional<PathTracer> paths_;
  std::optional<FinalGather> gather_;  ///< If `quality` is `gather`.
};

}  // namespace patchlight

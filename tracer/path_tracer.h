#pragma once
#include <tbb/enumerable_thread_specific.h>

#include <optional>

#include "pipeline/files/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/optics/material_shader.h"
#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/ray_scene.h"
#include "pipeline/optics/smooth_normals.h"
#include "tracer/display_lookup.h"
#include "tracer/irradiance_lookup.h"
#include "tracer/outlines.h"
#include "tracer/pixel_detail.h"
#include "tracer/pixel_light.h"

namespace patchlight {

/// What the paths of some pixels have come to.
struct PathSums {
  std::vector<Color> pixels;           ///< Sums of radiance, without light that is found at the pixel.
  std::vector<ShadingPoint> points;    ///< Where such light is still to be added.
  std::vector<PixelDetail> details{};  ///< Of each pixel; empty: not asked for.
  DisplayLookup::Seen seen{};
};

/// Follows paths from the camera to what they show: E / pi + rho H / pi at the first surface, plus what mirrors show. H
/// is interpolated; with `quality: direct` it lacks the direct light of emitters that are sampled apart, which
/// PixelLight adds. Mirrors are followed until what they pass on is below a thousandth. Where a primitive has a shader,
/// rho and E are its values at the hit, brought into range.
class PathTracer {
 public:
  /// A ray on its way.
  struct Path {
    std::uint32_t pixel = 0;  ///< Of the sums.
    Color throughput{1.0f};
    int mirrors = 0;
    PathView view{};
  };

  /// `irradiance`: of every patch, what is interpolated. `settings`: of the light groups. `emission`: of every patch.
  PathTracer(const PatchSet& scene, const RayScene& ray_scene, const Outlines& outlines, const EnergyField& energy,
             const TraceConfig& config, const std::vector<Color>& settings, const std::vector<Color>& emission);

  /// Follows the paths of a packet's valid lanes to their ends, and adds what they show to `sums`. They start at
  /// `camera`. Leaves no lane valid.
  void trace(RayPacket& packet, std::array<Path, RayPacket::kSize>& paths, const CameraRays& camera,
             PathSums& sums) const;

 private:
  /// Adds what a hit shows and turns the lane towards what its mirror shows; false when the path ends.
  bool shade(RayPacket& packet, int lane, Path& path, const CameraRays& camera, PathSums& sums) const;
  SurfacePoint point_of(const SurfaceHit& hit) const;
  Color irradiance_at(const SurfaceHit& hit, std::int32_t patch, std::uint32_t pixel, PathSums& sums) const;
  /// Replaces a patch's values by those of the shader at a hit.
  void apply_shader(const SurfaceHit& hit, Color& reflectance, Color& emission) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const Outlines& outlines_;
  const TraceConfig& config_;
  const std::vector<Color>& settings_;
  const std::vector<Color>& emission_;
  const bool direct_;
  PatchLookup lookup_;
  std::vector<Color> irradiance_;
  IrradianceLookup irradiance_lookup_;
  std::optional<DisplayLookup> display_;
  const SmoothNormals normals_;
  mutable tbb::enumerable_thread_specific<std::vector<MaterialShader>> shaders_;
};

}  // namespace patchlight

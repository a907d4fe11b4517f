#pragma once
#include <tbb/enumerable_thread_specific.h>

#include <optional>

#include "pipeline/files/image_file.h"
#include "pipeline/files/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/optics/material_shader.h"
#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/ray_scene.h"
#include "pipeline/stage/progress.h"
#include "tracer/camera_rays.h"
#include "tracer/display_lookup.h"
#include "tracer/irradiance_lookup.h"
#include "tracer/pixel_light.h"
#include "tracer/smooth_normals.h"

namespace patchlight {

/// Renders frames of one solved scene under one setting of its lights. Everything is shared between frames.
///
/// A pixel's radiance is the mean over stratified samples of E / pi + rho H / pi plus what mirrors show. H is
/// interpolated between patches, or, with `quality: direct`, but for the direct light, which is found at the pixel.
/// Mirrors are followed until what they pass on is below a thousandth. Where a primitive has a shader, rho and E are
/// its values at the hit, brought into range.
class Integrator {
 public:
  /// Throws: Error (bad_config) for a light group that the scene does not have.
  Integrator(const PatchSet& scene, const EnergyField& energy, const Job& job);

  /// Pixels are the same for any number of threads. Throws: Error (interrupted).
  Image render(const Camera& camera, Progress& progress) const;

 private:
  /// A ray on its way, and which pixel sample it belongs to.
  struct Path {
    std::uint32_t pixel = 0;
    Color throughput{1.0f};
    int mirrors = 0;
  };

  /// What the paths of a tile have come to.
  struct Tile {
    std::vector<Color> pixels;
    std::vector<ShadingPoint> points;  ///< Where direct light is still to be added.
  };

  void render(const CameraRays& rays, int x0, int y0, Image& image) const;
  void add_direct_light(Tile& tile, std::uint64_t seed) const;
  void trace(RayPacket& packet, std::array<Path, RayPacket::kSize>& paths, Tile& tile) const;
  /// Adds what a hit shows and turns the lane towards what its mirror shows; false when the path ends.
  bool shade(RayPacket& packet, int lane, Path& path, Tile& tile) const;
  SurfacePoint point_of(const SurfaceHit& hit) const;
  Color irradiance_at(const SurfaceHit& hit, std::int32_t patch) const;
  /// Replaces a patch's values by those of the shader at a hit.
  void apply_shader(const SurfaceHit& hit, Color& reflectance, Color& emission) const;

  const PatchSet& scene_;
  const TraceConfig& config_;
  RayScene ray_scene_;
  PatchLookup lookup_;
  std::vector<Color> settings_;    ///< [light groups].
  std::vector<Color> emission_;    ///< [patches], under the lights' settings.
  std::vector<Color> irradiance_;  ///< [patches], of all groups under the lights' settings; what `lights_` lacks.
  IrradianceLookup irradiance_lookup_;
  std::optional<DisplayLookup> display_;
  const SmoothNormals normals_;
  std::optional<PixelLight> lights_;  ///< With direct light at the pixel.
  mutable tbb::enumerable_thread_specific<std::vector<MaterialShader>> shaders_;
};

}  // namespace patchlight

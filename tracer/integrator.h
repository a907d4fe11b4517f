#pragma once
#include <tbb/enumerable_thread_specific.h>

#include "pipeline/files/image_file.h"
#include "pipeline/files/job.h"
#include "pipeline/model/energy_field.h"
#include "pipeline/optics/material_shader.h"
#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/ray_scene.h"
#include "pipeline/stage/progress.h"
#include "tracer/irradiance_lookup.h"

namespace patchlight {

/// Renders frames of one solved scene under one setting of its lights. Everything is shared between frames.
///
/// A pixel's radiance is the mean over stratified samples of E / pi + rho H / pi plus what mirrors show; mirrors are
/// followed until what they pass on is below a thousandth. Where a primitive has a shader, rho and E are its values at
/// the hit, brought into range.
class Integrator {
 public:
  /// Throws: Error (bad_config) for a light group that the scene does not have.
  Integrator(const PatchSet& scene, const EnergyField& energy, const Job& job);

  /// Pixels are the same for any number of threads. Throws: Error (interrupted).
  Image render(const Camera& camera, Progress& progress) const;

 private:
  /// A ray on its way, and which pixel sample it belongs to.
  struct Path {
    std::size_t pixel = 0;
    Color throughput{1.0f};
    int mirrors = 0;
  };

  void trace(RayPacket& packet, std::array<Path, RayPacket::kSize>& paths, Color* pixels) const;
  /// Adds what a hit shows and turns the lane towards what its mirror shows; false when the path ends.
  bool shade(RayPacket& packet, int lane, Path& path, Color* pixels) const;
  SurfacePoint point_of(const SurfaceHit& hit) const;
  /// Replaces a patch's values by those of the shader at a hit.
  void apply_shader(const SurfaceHit& hit, Color& reflectance, Color& emission) const;

  const PatchSet& scene_;
  const TraceConfig& config_;
  RayScene ray_scene_;
  PatchLookup lookup_;
  std::vector<Color> settings_;    ///< [light groups].
  std::vector<Color> emission_;    ///< [patches], under the lights' settings.
  std::vector<Color> irradiance_;  ///< [patches], of all groups under the lights' settings.
  IrradianceLookup irradiance_lookup_;
  mutable tbb::enumerable_thread_specific<std::vector<MaterialShader>> shaders_;
};

}  // namespace patchlight

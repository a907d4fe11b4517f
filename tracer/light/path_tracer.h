#pragma once
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/surface/smooth_normals.h"
#include "pipeline/optics/surface/texture_lookup.h"
#include "tracer/light/final_gather.h"
#include "tracer/light/metal_light.h"
#include "tracer/light/pixel_light.h"
#include "tracer/light/solved_surfaces.h"
#include "tracer/output/layers.h"
#include "tracer/sampling/camera_rays.h"
#include "tracer/sampling/outlines.h"
#include "tracer/sampling/pixel_detail.h"

namespace patchlight {

/// The rough metals that a packet's paths have met, and rays from there to emitters.
struct MetalRays {
  RayPacket packet;
  std::array<MetalLight::Place, RayPacket::kSize> places;  ///< The last that each path has met.
  std::array<MetalLight::Sample, RayPacket::kSize> samples;
  std::array<Color, RayPacket::kSize> throughputs;
  bool any = false;

  MetalRays() { packet.clear(); }
};

/// What the paths of some pixels have come to.
struct PathSums {
  std::vector<Color> pixels;                  ///< Sums of radiance, without light that is found at the pixel.
  std::vector<ShadingPoint> points;           ///< Where such light is still to be added.
  std::vector<GatherPoint> gather{};          ///< Where other light is; none unless by `quality: gather`.
  std::vector<PixelDetail> details{};         ///< Of each pixel; empty: not asked for.
  LayerSums* layers = nullptr;                ///< Null: not asked for.
  const TileLight::Window* window = nullptr;  ///< Of the pixels.
  std::optional<MetalRays> metal_rays{};      ///< Where there are rough metals.
  DisplayLookup::Seen seen{};
};

/// Follows paths from the camera to what they show: E / pi + rho H / pi at the first surface, plus what metals show. H
/// is interpolated; with `quality: direct` it lacks the direct light of emitters that are sampled apart, which
/// PixelLight adds; with `quality: gather` FinalGather adds the rest of it. Metals are followed until what they pass on
/// is below a thousandth: mirrors the one way, rough ones by a direction of their GGX lobe for each sample, a pixel's
/// being stratified together, and by MetalLight.
///
/// What a path has come to for PixelDetail is light at the scene's own strength, so that the lights' settings have no
/// say in where samples go.
class PathTracer {
 public:
  /// A ray on its way.
  struct Path {
    std::uint32_t pixel = 0;   ///< Of the sums.
    std::uint32_t sample = 0;  ///< Of the pixel's.
    float off = 0.0f;          ///< From the pixel's middle, squared; for layers.
    Color throughput{1.0f};
    int surfaces = 0;  ///< Metals, and backs that it went through.
    bool mirrored = false;
    float density = 0.0f;  ///< Of the last turn, by a rough metal, per sr; 0: the last turn was not by one.
    PathView view{};
  };

  PathTracer(const PatchSet& scene, const RayScene& ray_scene, const Outlines& outlines, const SolvedSurfaces& surfaces,
             const LightMixes& mixes, const TraceConfig& config);

  /// Follows the paths of a packet's valid lanes to their ends, and adds what they show to `sums`. They start at
  /// `camera`. Leaves no lane valid.
  void trace(RayPacket& packet, std::array<Path, RayPacket::kSize>& paths, const CameraRays& camera,
             PathSums& sums) const;

 private:
  /// Adds what a hit shows and turns the lane towards what a metal there shows; false when the path ends.
  bool shade(RayPacket& packet, int lane, Path& path, const CameraRays& camera, PathSums& sums) const;
  void show_sky(const Vec3f& direction, Path& path, PathSums& sums) const;
  void add_layers(const SurfaceHit& hit, const SolvedSurfaces::Colors& colors, const DisplayLookup::Blend& blend,
                  const Path& path, LayerSums& layers) const;
  /// Turns `direction` as a metal does; `normal`: smooth. False: it reflects nothing.
  bool turn(const MetallicRoughness& metal, const Vec3d& off, const Vec3f& normal, const Vec3f& flat, int lane,
            Path& path, Vec3f& direction, PathSums& sums) const;
  void ask_for_metal_light(const MetallicRoughness& metal, std::uint64_t seed, int lane, const Path& path,
                           MetalRays& rays) const;
  void add_metal_light(std::array<Path, RayPacket::kSize>& paths, PathSums& sums) const;
  SurfacePoint point_of(const SurfaceHit& hit) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const Outlines& outlines_;
  const SolvedSurfaces& surfaces_;
  const LightMixes& mixes_;
  const TraceConfig& config_;
  const bool direct_, gather_;
  const SmoothNormals normals_;
  std::optional<MetalLight> metals_;  ///< Where there are rough ones.
};

}  // namespace patchlight

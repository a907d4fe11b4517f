#pragma once
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/surface/coat_albedo.h"
#include "pipeline/optics/surface/smooth_normals.h"
#include "pipeline/optics/surface/texture_lookup.h"
#include "tracer/light/passed_lamps.h"
#include "tracer/light/solution/solved_surfaces.h"
#include "tracer/sampling/camera_rays.h"
#include "tracer/sampling/outlines.h"

namespace patchlight {

/// Traces camera paths to the solved surfaces. Each surface adds E / pi + rho H / pi and, if it is a metal or coated,
/// its specular reflection. H is interpolated from the solution. With `quality: direct` it excludes the direct light of
/// sampled emitters, which TileLight adds; with `quality: gather` FinalGather adds the rest as well. Paths
/// follow specular reflections until their throughput is below a thousandth: mirrors deterministically, rough ones by
/// one direction of the GGX lobe for each sample, stratified over the pixel, and by GlossyLights.
///
/// The light in PathFeatures is at the scene's own strength, so the distribution of samples does not depend on the
/// lights' settings.
class PathTracer {
 public:
  using Path = CameraPath;

  /// `glossy_lights`: not null if the scene has rough metals or coats.
  PathTracer(const PatchSet& scene, const RayScene& ray_scene, const Outlines& outlines, const SolvedSurfaces& surfaces,
             const LightMixes& mixes, const GlossyLights* glossy_lights, const TraceConfig& config);

  /// Traces the paths of a packet's valid lanes, which start at `camera`, to their ends and adds them to `sums`.
  /// Leaves no lane valid.
  void trace(RayPacket& packet, std::array<Path, RayPacket::kSize>& paths, const CameraRays& camera,
             PathSums& sums) const;

 private:
  void trace_to_ends(RayPacket& packet, std::array<Path, RayPacket::kSize>& paths, const CameraRays& camera,
                     PathSums& sums) const;
  /// Adds the light of a lane's hit and sets its next ray; false when the path ends.
  bool shade(RayPacket& packet, int lane, Path& path, const CameraRays& camera, PathSums& sums) const;
  void add_sky(const Vec3f& direction, Path& path, PathSums& sums) const;
  /// A side of a surface that sends out diffusely what falls on it.
  struct DiffuseSide {
    SurfaceHit hit;
    SolvedSurfaces::Colors colors;
    Vec3d position;              ///< Offset from the surface.
    Vec3f normal, smooth, flat;  ///< For the light; before valid_for_viewer(); geometric.
  };
  void add_diffuse_light(const DiffuseSide& side, int lane, const CameraRays& camera, Path& path, PathSums& sums) const;
  void add_layers(const SurfaceHit& hit, const SolvedSurfaces::Colors& colors, const DisplayLookup::Blend& blend,
                  bool looked_up, const Path& path, LayerSums& layers) const;
  bool survives(const SpecularProperties& specular, const Color& albedo, Path& path, const PathSums& sums) const;
  /// Reflects `direction`; false if nothing is reflected. `origin`: of the next ray.
  bool scatter(const SpecularProperties& specular, std::int32_t primitive, const Vec3d& origin,
               const Vec3f& smooth_normal, const Vec3f& geometric_normal, int lane, Path& path, Vec3f& direction,
               PathSums& sums) const;
  /// Whether a clear coat reflects a path, by chance; a smooth one on the first surface reflects a part of it besides.
  /// `normal`: of the coat. Multiplies the throughput by what is not reflected.
  bool reflects_at_clear_coat(const SurfaceHit& hit, const SurfacePoint& point, const SpecularProperties& specular,
                              const Vec3f& normal, const Vec3f& in, Path& path, PathSums& sums) const;
  /// Adds the part of a path that a smooth surface reflects, to be traced besides it. `facing`: geometric normal on the
  /// path's side.
  void add_part(const SurfaceHit& hit, const Vec3d& position, const Vec3f& facing, const Vec3f& normal, const Vec3f& in,
                const Color& reflectance, const Path& path, PathSums& sums) const;
  /// Chooses whether a path goes on through a surface that lets light pass, or is reflected; false if it ends.
  bool pass(const SurfaceHit& hit, const SurfacePoint& point, int lane, Path& path, RayPacket& packet,
            PathSums& sums) const;
  void sample_glossy_light(const SpecularProperties& specular, std::uint64_t seed, int lane, const Path& path,
                           GlossyShadowRays& rays) const;
  std::uint32_t pass_shadow_rays(RayPacket& packet, std::span<Color> light) const;
  void add_glossy_light(std::array<Path, RayPacket::kSize>& paths, PathSums& sums) const;
  void lift_point(const SurfaceHit& hit, int lane, PathSums& sums) const;
  void move_lifted_points(PathSums& sums) const;
  SurfacePoint surface_point(const SurfaceHit& hit) const;

  static constexpr float kMinThroughput = 1e-3f;
  static constexpr int kMaxBounces = 64;
  /// Throughput of a coat below which what it shows needs no more samples than the rest.
  static constexpr float kFaint = 0.15f;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  std::optional<PassedLamps> lamps_;  ///< Empty: no intangible ones.
  const Outlines& outlines_;
  const SolvedSurfaces& surfaces_;
  const LightMixes& mixes_;
  const TraceConfig& config_;
  const bool direct_, gather_;
  const SmoothNormals normals_;
  const CoatAlbedos coats_;
  const GlossyLights* const glossy_lights_;
};

}  // namespace patchlight

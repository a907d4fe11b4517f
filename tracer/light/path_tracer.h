#pragma once
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/surface/smooth_normals.h"
#include "pipeline/optics/surface/texture_lookup.h"
#include "tracer/light/explicit_lights.h"
#include "tracer/light/final_gather.h"
#include "tracer/light/glossy_lights.h"
#include "tracer/light/solved_surfaces.h"
#include "tracer/output/layer_sums.h"
#include "tracer/sampling/camera_rays.h"
#include "tracer/sampling/outlines.h"
#include "tracer/sampling/pixel_detail.h"

namespace patchlight {

/// Shadow rays from a packet's last vertices on rough metals to emitters.
struct GlossyShadowRays {
  RayPacket packet;
  std::array<GlossyLights::Vertex, RayPacket::kSize> vertices;  ///< The last vertex of each path.
  std::array<GlossyLights::Sample, RayPacket::kSize> samples;
  std::array<Color, RayPacket::kSize> throughputs;
  bool pending = false;  ///< Some lanes wait to be cast.

  GlossyShadowRays() { packet.clear(); }
};

/// Shading points of a packet that are to be moved to the smooth surface that normals describe, unless another surface
/// is in between.
struct LiftedPoints {
  RayPacket packet;                                    ///< Rays from the points to their new places.
  std::array<std::size_t, RayPacket::kSize> points{};  ///< Indices into PathSums::points.
  std::array<Vec3d, RayPacket::kSize> positions{};     ///< Of the new places.
  bool pending = false;                                ///< Some lanes wait to be cast.

  LiftedPoints() { packet.clear(); }
};

/// Sums over the paths of some pixels.
struct PathSums {
  std::vector<Color> pixels;                      ///< Sums of radiance, without light that is added at the pixel.
  std::vector<ShadingPoint> points;               ///< Where direct light of sampled emitters is to be added.
  std::vector<GatherPoint> gather{};              ///< Where gathered light is to be added; `quality: gather` only.
  std::vector<PixelDetail> details{};             ///< [pixels]; empty: not asked for.
  LayerSums* layers = nullptr;                    ///< Null: not asked for.
  const TileWindow* window = nullptr;             ///< Of the pixels.
  std::optional<GlossyShadowRays> glossy_rays{};  ///< Once a path has hit a rough metal.
  std::optional<LiftedPoints> lifted{};           ///< Once a path has hit a curved mesh.
};

/// Traces camera paths to the solved surfaces. Each surface adds E / pi + rho H / pi and, if it is a metal, its
/// specular reflection. H is interpolated from the solution. With `quality: direct` it excludes the direct light of
/// sampled emitters, which TileLight adds; with `quality: gather` FinalGather adds the rest as well. Paths
/// follow specular reflections until their throughput is below a thousandth: mirrors deterministically, rough metals by
/// one direction of the GGX lobe for each sample, stratified over the pixel, and by GlossyLights.
///
/// The light in PathFeatures is at the scene's own strength, so the distribution of samples does not depend on the
/// lights' settings.
class PathTracer {
 public:
  /// A camera path in progress.
  struct Path {
    std::uint32_t pixel = 0;        ///< Index in the sums.
    std::uint32_t sample = 0;       ///< Of the pixel.
    float center_distance2 = 0.0f;  ///< Squared distance from the pixel's centre; for layers.
    bool central = false;           ///< A ray through the centres of pixel and lens, for layers alone.
    Color throughput{1.0f};
    int bounces = 0;  ///< Specular reflections, and surfaces passed through.
    bool mirrored = false;
    float pdf = 0.0f;  ///< Of the present direction if a rough metal reflected it, per sr; otherwise 0.
    PathFeatures features{};

    ShadingPoint::PathKind kind() const {
      using Kind = ShadingPoint::PathKind;
      return features.scattered ? Kind::scattered : mirrored ? Kind::mirrored : Kind::direct;
    }
  };

  /// `glossy_lights`: not null if the scene has rough metals.
  PathTracer(const PatchSet& scene, const RayScene& ray_scene, const Outlines& outlines, const SolvedSurfaces& surfaces,
             const LightMixes& mixes, const GlossyLights* glossy_lights, const TraceConfig& config);

  /// Traces the paths of a packet's valid lanes, which start at `camera`, to their ends and adds them to `sums`.
  /// Leaves no lane valid.
  void trace(RayPacket& packet, std::array<Path, RayPacket::kSize>& paths, const CameraRays& camera,
             PathSums& sums) const;

 private:
  /// Adds the light of a lane's hit and sets its next ray; false when the path ends.
  bool shade(RayPacket& packet, int lane, Path& path, const CameraRays& camera, PathSums& sums) const;
  void add_sky(const Vec3f& direction, Path& path, PathSums& sums) const;
  void add_layers(const SurfaceHit& hit, const SolvedSurfaces::Colors& colors, const DisplayLookup::Blend& blend,
                  const Path& path, LayerSums& layers) const;
  /// Reflects `direction` at a metal; false if nothing is reflected. `origin`: of the next ray.
  bool scatter(const MetalProperties& metal, const Vec3d& origin, const Vec3f& smooth_normal,
               const Vec3f& geometric_normal, int lane, Path& path, Vec3f& direction, PathSums& sums) const;
  void sample_glossy_light(const MetalProperties& metal, std::uint64_t seed, int lane, const Path& path,
                           GlossyShadowRays& rays) const;
  void add_glossy_light(std::array<Path, RayPacket::kSize>& paths, PathSums& sums) const;
  void lift_point(const SurfaceHit& hit, int lane, PathSums& sums) const;
  void move_lifted_points(PathSums& sums) const;
  SurfacePoint surface_point(const SurfaceHit& hit) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const Outlines& outlines_;
  const SolvedSurfaces& surfaces_;
  const LightMixes& mixes_;
  const TraceConfig& config_;
  const bool direct_, gather_;
  const SmoothNormals normals_;
  const GlossyLights* const glossy_lights_;
};

}  // namespace patchlight

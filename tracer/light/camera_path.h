#pragma once
#include <optional>
#include <vector>

#include "pipeline/optics/surface/glass.h"
#include "tracer/light/final_gather.h"
#include "tracer/light/lamps/explicit_lights.h"
#include "tracer/light/lamps/glossy_lights.h"
#include "tracer/output/layer_sums.h"
#include "tracer/sampling/pixel_detail.h"

namespace patchlight {

/// A camera path in progress.
struct CameraPath {
  std::uint32_t pixel = 0;        ///< Index in the sums.
  std::uint32_t sample = 0;       ///< Of the pixel.
  float center_distance2 = 0.0f;  ///< Squared distance from the pixel's centre; for layers.
  bool central = false;           ///< A ray through the centres of pixel and lens, for layers alone.
  Color throughput{1.0f};
  int bounces = 0;  ///< Specular reflections, and surfaces passed through.
  SeenBy seen_by = SeenBy::itself;
  bool scattered = false;    ///< By rough metals or coats.
  bool faint = false;        ///< A coat reflected so little that what it meets is looked up in the solution.
  bool is_part = false;      ///< A reflection by the first surface, traced besides the path that met it.
  float parts = 1.0f;        ///< Number of parts into which the first surface split what it reflects.
  float pdf = 0.0f;          ///< Of the present direction if a rough surface reflected it, per sr; otherwise 0.
  std::int32_t mirror = -1;  ///< That reflected it since, with virtual images of the lamps; -1: none.
  GlassEntry entry{};
  PathFeatures features{};

  /// The part of the light of all parts together that it carries on.
  Color whole_throughput() const { return throughput * parts; }
  /// Whether all that the path met so far let it pass straight.
  bool is_direct() const { return seen_by == SeenBy::itself; }
  /// The first surface that turns the path decides.
  void turn(SeenBy by) {
    if (is_direct()) seen_by = by;
  }
};

/// Shadow rays from a packet's last vertices on rough surfaces to emitters.
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
  std::vector<Color> pixels;           ///< Sums of radiance, without light that is added at the pixel.
  std::vector<ShadingPoint> points;    ///< Where direct light of sampled emitters is to be added.
  std::vector<GatherPoint> gather{};   ///< Where gathered light is to be added; `quality: gather` only.
  std::vector<PixelDetail> details{};  ///< [pixels]; empty: not asked for.
  LayerSums* layers = nullptr;         ///< Null: not asked for.
  const TileWindow* window = nullptr;  ///< Of the pixels.
  std::uint32_t first_samples = 0;     ///< That each pixel takes at least.
  /// A reflection by the first surface that a path met.
  struct Part {
    CameraPath path;
    Vec3f origin, direction;        ///< In the local frame of the RayScene.
    GlossyLights::Vertex vertex{};  ///< Where a rough surface reflected it.
  };
  std::vector<Part> parts{};                      ///< Yet to be traced.
  std::optional<GlossyShadowRays> glossy_rays{};  ///< Once a path has hit a rough metal or coat.
  std::optional<LiftedPoints> lifted{};           ///< Once a path has hit a curved mesh.
};

}  // namespace patchlight

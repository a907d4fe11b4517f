#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/intersect/embree_tracer.h"
#include "pipeline/optics/intersect/packet_tracer.h"
#include "pipeline/optics/intersect/ray_packet.h"

namespace patchlight {

/// The closest hit of a ray: a primitive and its (u,v).
struct SurfaceHit {
  std::int32_t primitive = -1;  ///< -1: no hit.
  bool front = false;           ///< False: the unlit back of a single-sided primitive.
  float u = 0.0f;
  float v = 0.0f;
  float t = 0.0f;
  bool at_edge = false;  ///< On a parallelogram's margin, which closes the gaps of rounding to its neighbours.
};

/// A scene's primitives for ray casting, in single precision relative to the scene's centre; both sides of a surface
/// are one primitive, a region its pieces. A PacketTracer traces them; Embree does, if they are very many or if fine
/// ones cover much of the area. Masked primitives have an Embree BVH of their own with the alpha test as hit filter,
/// that scenes without masks skip. Surfaces that let light pass form a RayScene of their own. The PatchSet must outlive
/// the RayScene. Hits do not depend on the number of threads.
class RayScene {
 public:
  enum class Tracer { fastest, packets, embree };  ///< Of unmasked primitives; fastest: see SurfaceSizes.

  /// The surfaces that it holds: all that rays meet, those alone that let light pass (see lets_light_pass()), or the
  /// intangible lamps (see Primitive::intangible).
  enum class Surfaces { tangible, passable, intangible };

  explicit RayScene(const PatchSet& scene, Tracer tracer = Tracer::fastest, Surfaces surfaces = Surfaces::tangible);
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  Vec3f to_local(const Vec3d& world) const { return Vec3f(world - origin_); }
  std::array<Vec3f, 4> to_local(const std::array<Vec3d, 4>& world) const {
    return {to_local(world[0]), to_local(world[1]), to_local(world[2]), to_local(world[3])};
  }

  /// Offset of ray origins from primitive `i` along its normal that avoids self-intersection, m: a bound of the
  /// rounding of its points along the normal, plus the largest distance between a quad's bilinear surface and the plane
  /// or the two triangles that are traced. Positive.
  float offset(std::int32_t i) const { return offsets_[i]; }

  /// Whether even similar rays hit different primitives: see SurfaceSizes.
  bool mostly_fine() const { return mostly_fine_; }

  /// Finds the closest hits of the active lanes. `coherent`: hint for Embree that the rays are similar.
  void intersect(RayPacket& packet, bool coherent) const;

  /// The active lanes that surfaces occlude which let no light pass, a bit each.
  std::uint32_t occluded(RayPacket& packet) const;

  /// Whether some surfaces let light pass.
  bool has_passable() const { return passable_ != nullptr; }

  using Transmittances = std::array<Color, RayPacket::kSize>;

  /// Of unoccluded lanes, what the surfaces on their way let pass straight. Rays pass bodies of glass where they are
  /// plates (see is_plate()), without an offset and with all orders of reflection between the faces; nothing passes
  /// other bodies straight, nor rough glass. Ones, if there are no such surfaces.
  Transmittances transmittances(const RayPacket& packet, std::uint32_t lanes) const;

  SurfaceHit hit(const RayPacket& packet, int lane) const;

 private:
  struct Quad {
    std::int32_t front;
    std::int32_t back;
    float a;  ///< Corner 2 = corner 0 + a * (corner 1 - corner 0) + b * (corner 3 - corner 0).
    float b;
    Vec3f normal;
    bool two_triangles;       ///< Not planar: traced as two triangles.
    std::int32_t piece = -1;  ///< Of a region: index into pieces_; -1: a whole quad.
  };
  /// (u,v) of a region's piece: at its corner 0, and how it changes along its edges.
  struct Piece {
    Vec2f corner, along, across;
  };
  struct Sphere {
    std::int32_t outside;
    std::int32_t inside;
    Vec3f center;
  };

  void add_quads(const PatchSet& scene, Surfaces surfaces);
  void add_spheres(const PatchSet& scene, Surfaces surfaces);
  bool accepts_hit(unsigned quad, const Vec2f& at, const Vec3f& origin, const Vec3f& direction, float distance) const;
  SurfaceHit surface_hit(unsigned geometry, unsigned index, float s, float t, const Vec3f& origin,
                         const Vec3f& direction, float distance) const;

  Vec3d origin_{0.0};
  bool mostly_fine_;
  std::optional<PacketTracer> packet_tracer_;
  std::vector<float> offsets_;
  std::vector<Quad> quads_;
  std::vector<Piece> pieces_;
  std::vector<Sphere> spheres_;
  std::unique_ptr<EmbreeTracer> embree_;         ///< Unmasked primitives; null: the PacketTracer has them.
  std::unique_ptr<EmbreeTracer> masked_embree_;  ///< Masked primitives; null: none.
  std::unique_ptr<const RayScene> passable_;     ///< Of the same local frame; null: none.
  const PatchSet* scene_ = nullptr;
};

/// What a surface that lets light pass does so of a straight ray; of one inside of a body, that started where it
/// entered the body, also what this leaves of it.
Color straight_transmittance(const PatchSet& scene, const SurfaceHit& hit, const Vec3f& direction);

/// (u,v) of a sphere in a direction (any length) from its centre.
Vec2f sphere_uv(const Vec3f& direction);

}  // namespace patchlight

#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/lights/light_tree.h"
#include "pipeline/optics/lights/plane_mirror.h"

namespace patchlight {

/// An emitter that is sampled as one: a primitive with uniform emission, a single patch, or a Light.
struct Emitter {
  std::int32_t primitive = 0;    ///< -1: a Light.
  std::int32_t first_patch = 0;  ///< Of a Light: the number of patches of the scene.
  std::int32_t patches = 0;
  double area = 0.0;        ///< m2.
  std::int32_t light = -1;  ///< Index into PatchSet::lights; -1: a surface.
};

/// The emitters of a scene that are sampled individually: unmasked quads, and unmasked spheres that are lit outside. A
/// primitive with uniform emission is one emitter; other quads are one emitter per patch. The largest primitives are
/// chosen, up to 64 emitters. All Lights are added. Sorted by first patch.
std::vector<Emitter> explicit_emitters(const PatchSet& scene);

/// The other quads that emit, and spheres that are lit outside, of which a LightTree chooses some for each receiver:
/// all patches of a primitive together. Masked ones above a hundredth of the scene's area are left out: rays find them
/// well, and samples of a mask with holes are noisy. Sorted by first patch.
std::vector<Emitter> further_emitters(const PatchSet& scene);

/// Unoccluded direct light of one emitter at a point, and shadow ray samples towards it.
///
/// A form factor is the irradiance for a radiant exitance of 1; of a Light, for a strength of 1 (in 1/m2 if the
/// strength is a radiant intensity).
class DirectLight {
 public:
  /// A shadow ray towards a point of the emitter.
  struct Sample {
    Vec3f direction;        ///< Unit length.
    float distance = 0.0f;  ///< To just before the emitter, m.
    float weight = 0.0f;    ///< Its mean over the unit square is the form factor; 0: does not contribute.
  };

  DirectLight(const PatchSet& scene, const RayScene& ray_scene, const Emitter& emitter);

  /// A sphere to sample directions towards, whatever it contains.
  DirectLight(const Vec3d& center, double radius)
      : kind_(Kind::sphere), end_offset_(0.0), center_(center), radius_(radius) {}

  /// `distribution`: of a light that has one; must outlive this object.
  explicit DirectLight(const Light& light, const LightDistribution* distribution = nullptr);

  /// The virtual image of this light that a mirror shows.
  DirectLight image(const PlaneMirror& mirror) const;

  LightBounds bounds() const;

  /// Centre and radius of the bounding sphere.
  const Vec3d& center() const { return center_; }
  double radius() const { return radius_; }

  /// Whether it has no extent: all samples from a point are the same, and no path hits it.
  bool is_point() const { return kind_ == Kind::point || kind_ == Kind::sun; }

  /// Unoccluded form factor from a surface element to the whole emitter, clipped at the element's horizon.
  /// Polygons: Lambert's formula (Baum, Rushmeier and Winget 1989, eq. 5); spheres: Snyder 1996.
  double form_factor(const Vec3d& point, const Vec3f& normal) const;

  /// Whether the emitter lights no point of a planar surface with these corners, even without occluders.
  bool cannot_illuminate(std::span<const Vec3d> corners, const Vec3f& normal) const;

  /// Distance from a point to the emitter's bounding sphere, m; 0 inside.
  double distance(const Vec3d& point) const {
    if (is_infinite()) return std::numeric_limits<double>::infinity();
    return std::max(0.0, (point - center_).length() - radius_);
  }

  /// Rough estimate of the fraction of directions that the emitter covers, in [0,1]; 0 on its unlit side. Of a Light:
  /// perpendicular_factor().
  double apparent_size(const Vec3d& point) const {
    if (is_point() || is_infinite() || kind_ == Kind::ball) return perpendicular_factor(point);
    const Vec3d from = point - center_;
    if (kind_ == Kind::polygon && height(point) <= 0) return 0.0;
    return radius_ * radius_ / std::max(from.length2(), radius_ * radius_);
  }

  /// Form factor of a Light from a surface element that faces its centre. Of a Light with a radius: as of its centre.
  double perpendicular_factor(const Vec3d& point) const;

  /// Radiant intensity of a point light or a spot in a direction of unit length, over its strength.
  double relative_intensity(const Vec3d& direction) const;

  /// Precomputed data for many samples from one point.
  class View {
   public:
    /// Samples a point of the emitter by (x,y) of the unit square: uniform in solid angle, or in area if far away.
    Sample sample(float x, float y) const;

    /// Probability density of sample() for a direction that hits the emitter, per sr; 0 without extent.
    double density(const Vec3f& direction) const;

    /// Form factor of a Light from a surface element that faces a sample's direction, with the weight of the sample.
    double perpendicular_weight(const Sample& sample) const;

   private:
    friend class DirectLight;
    struct Triangle {  ///< A spherical triangle.
      Vec3d a, b, c;
      Vec3d tangent;        ///< Unit tangent at a towards c.
      double sine, cosine;  ///< Of `angle`, the angle at a.
      double angle, area;

      Triangle() {}  // uninitialised for speed: most views do not use it
      Triangle(const Vec3d& p, const Vec3d& q, const Vec3d& r);
      Vec3d direction(double x, double y) const;
    };

    Sample sample_polygon(double x, double y) const;
    Sample sample_sphere(double x, double y) const;
    Sample sample_disk(double x, double y) const;
    Sample sample_ball(double x, double y) const;
    Sample sample_point() const;

    const DirectLight* light_ = nullptr;
    Vec3d point_{0.0};
    Vec3f normal_{0.0f};
    double height_ = 0.0;                ///< Above a polygon's plane, m; 0: unlit.
    float end_scale_ = 1.0f;             ///< Fraction of the distance to a polygon at which shadow rays end.
    double solid_angle_ = 0.0;           ///< Of a polygon, sr; 0: it is sampled by area.
    Vec3d to_corner_{0.0};               ///< Vector from the point to corner 0 of a polygon.
    std::array<Triangle, 2> triangles_;  ///< Of a polygon that is sampled by solid angle.
  };
  /// Beyond `far` radii of the bounding sphere, polygons are sampled by area instead of solid angle.
  View view(const Vec3d& point, const Vec3f& normal, double far = kFar) const;
  static constexpr double kFar = 4.0;

  Sample sample(const Vec3d& point, const Vec3f& normal, float x, float y) const {
    return view(point, normal).sample(x, y);
  }

 private:
  /// `ball` is a point light or a spot with a radius. `sun` and `disk`, a sun with a radius, are at infinity.
  enum class Kind { polygon, sphere, point, sun, disk, ball };

  bool is_infinite() const { return kind_ == Kind::sun || kind_ == Kind::disk; }

  /// Above the plane of a polygon, less the tolerance of the plane, m; not positive: unlit. So neither the other side
  /// of the same surface nor a coplanar one is lit, however their coordinates are rounded.
  double height(const Vec3d& point) const { return ((point - center_) ^ normal_) - plane_tolerance_; }

  Vec3d center_direction(const Vec3d& point) const;
  double ball_form_factor(const Vec3d& point, const Vec3d& normal) const;
  bool is_at_edge_of_cone(const Vec3d& point) const;
  double polygon_form_factor(const Vec3d& point, const Vec3d& normal) const;
  double sphere_form_factor(const Vec3d& point, const Vec3d& normal) const;

  Kind kind_;
  double end_offset_ = 0.0;       ///< Distance from the emitter at which shadow rays end, m.
  double plane_tolerance_ = 0.0;  ///< Of a polygon: bound of the rounding of points in its plane, m.
  Vec3d center_;                  ///< Of the sphere or point light; mean of a polygon's corners.
  double radius_ = 0.0;   ///< Of the sphere, or of a polygon's bounding sphere, m; sine of a disk's angular radius.
  int corner_count_ = 0;  ///< Of a polygon.
  /// Counter-clockwise as seen from the lit side.
  std::array<Vec3d, 4> corners_{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};
  Vec3d normal_{0.0};                                               ///< Of a polygon; direction of a spot or a sun.
  std::array<Vec3d, 3> edges_{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};  ///< Of a polygon, from corner 0 to the others.
  double area_ = 0.0, first_triangle_part_ = 1.0;      ///< Of a polygon, m2; fraction of its triangle 0 1 2.
  double cos_outer_ = -2.0, inverse_cos_range_ = 1.0;  ///< Angular falloff of a spot.
  bool is_directed_ = false;                           ///< Of a Light: its intensity depends on the direction.
  const LightDistribution* distribution_ = nullptr;    ///< Of a Light; null: none.
  Vec3d across_{0.0}, along_{0.0};                     ///< Half-planes C0 and C90 of the distribution.
};

}  // namespace patchlight

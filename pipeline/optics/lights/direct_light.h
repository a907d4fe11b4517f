#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "pipeline/model/patch_set.h"
#include "pipeline/optics/intersect/ray_scene.h"

namespace patchlight {

/// What is sampled apart from everything else: a primitive that emits alike all over, a patch, or a light without
/// extent.
struct Emitter {
  std::int32_t primitive = 0;    ///< -1: none.
  std::int32_t first_patch = 0;  ///< Of a light: as many as there are patches.
  std::int32_t patches = 0;
  double area = 0.0;        ///< m2.
  std::int32_t light = -1;  ///< Index into PatchSet::lights; -1: a surface.
};

/// The emitters of a scene that are worth sampling one by one: planes and spheres lit outside, each whole where it
/// emits alike all over, planes patch by patch where not, nothing that is masked; the largest primitives first, as long
/// as they make 64 at most; and behind these all lights without extent. By growing first patch. The rest is found by
/// chance, as anything else is.
std::vector<Emitter> explicit_emitters(const PatchSet& scene);

/// The light of one emitter at a point: how much of it would arrive if nothing stood between, and where to look.
///
/// A form factor is the irradiance for a surface's radiant exitance of 1; of a light without extent, for a strength of
/// 1, in 1/m2 where that is an intensity.
class DirectLight {
 public:
  /// A direction to a point of the emitter.
  struct Sample {
    Vec3f direction;        ///< Unit length.
    float distance = 0.0f;  ///< To just short of the emitter, m.
    float weight = 0.0f;    ///< Its mean over the unit square is the form factor; 0: below a horizon.
  };

  DirectLight(const PatchSet& scene, const RayScene& ray_scene, const Emitter& emitter);

  /// A ball, to look at what it holds.
  DirectLight(const Vec3d& center, double radius) : kind_(Kind::sphere), gap_(0.0), center_(center), radius_(radius) {}

  explicit DirectLight(const Light& light);

  /// Of a ball about a surface.
  const Vec3d& center() const { return center_; }
  double radius() const { return radius_; }

  /// Whether it has no extent, so that all looks from a point are the same, and no path meets it.
  bool is_point() const { return kind_ == Kind::point || kind_ == Kind::sun; }

  /// Form factor from a surface element to the whole emitter if nothing hides it, cut at the element's horizon.
  /// Polygons: Lambert's formula (Baum, Rushmeier and Winget 1989, eq. 5); spheres: Snyder 1996.
  double form_factor(const Vec3d& point, const Vec3f& normal) const;

  /// Whether nothing of the emitter lights any point of a plane piece of surface with these corners.
  bool is_behind(std::span<const Vec3d> corners, const Vec3f& normal) const;

  /// From a point to the sphere about the emitter, or 0 inside it, m.
  double distance(const Vec3d& point) const {
    if (is_far()) return std::numeric_limits<double>::infinity();
    return std::max(0.0, (point - center_).length() - radius_);
  }

  /// About the part of all directions in which the emitter lies, in [0,1]; 0 from where it does not shine. Of a light
  /// without extent: perpendicular_factor().
  double apparent_size(const Vec3d& point) const {
    if (is_point() || is_far()) return perpendicular_factor(point);
    const Vec3d from = point - center_;
    if (kind_ == Kind::polygon && (from ^ normal_) <= 0) return 0.0;
    return radius_ * radius_ / std::max(from.length2(), radius_ * radius_);
  }

  /// From a surface element that faces a light without extent.
  double perpendicular_factor(const Vec3d& point) const;

  /// The emitter as one point sees it: what its samples have in common, so that many cost little.
  class View {
   public:
    /// A point of the emitter for (x,y) of the unit square: uniform in solid angle, or in area where that is the same.
    Sample sample(float x, float y) const;

    /// With which samples take a direction that meets the emitter, per sr; 0 without extent.
    double density(const Vec3f& direction) const;

   private:
    friend class DirectLight;
    struct Triangle {  ///< On the unit sphere.
      Vec3d a, b, c;
      Vec3d toward_c;       ///< At a, at right angles to it.
      double sine, cosine;  ///< Of `angle`, the one at a.
      double angle, area;

      Triangle() {}  // not worth clearing: most points do not use it
      Triangle(const Vec3d& p, const Vec3d& q, const Vec3d& r);
      Vec3d direction(double x, double y) const;
    };

    Sample of_polygon(double x, double y) const;
    Sample of_sphere(double x, double y) const;
    Sample of_disk(double x, double y) const;
    Sample of_point() const;

    const DirectLight* light_ = nullptr;
    Vec3d point_{0.0};
    Vec3f normal_{0.0f};
    double height_ = 0.0;             ///< Above a polygon's plane; 0: sees nothing.
    float short_ = 1.0f;              ///< Part of the way to it after which rays end.
    double solid_angle_ = 0.0;        ///< Of a polygon that is sampled by it; 0: by area.
    Vec3d to_first_{0.0};             ///< A polygon's corner 0, from the point.
    std::array<Triangle, 2> halves_;  ///< Where it is.
  };
  /// Beyond `far` radii of the emitter area and solid angle are taken to be the same.
  View view(const Vec3d& point, const Vec3f& normal, double far = kFar) const;
  static constexpr double kFar = 4.0;

  Sample sample(const Vec3d& point, const Vec3f& normal, float x, float y) const {
    return view(point, normal).sample(x, y);
  }

 private:
  enum class Kind { polygon, sphere, point, sun, disk };  ///< `sun` and `disk` are infinitely far away.

  bool is_far() const { return kind_ == Kind::sun || kind_ == Kind::disk; }

  Vec3d towards(const Vec3d& point) const;
  double polygon_form_factor(const Vec3d& point, const Vec3d& normal) const;
  double sphere_form_factor(const Vec3d& point, const Vec3d& normal) const;

  Kind kind_;
  double gap_ = 0.0;     ///< How far from the emitter a ray must end so as not to meet it, m.
  Vec3d center_;         ///< Of the sphere, or the mean of the corners; where a point light stands.
  double radius_ = 0.0;  ///< Of the sphere, or about all corners.
  int count_ = 0;        ///< Corners.
  /// Counter-clockwise as seen from the lit side.
  std::array<Vec3d, 4> corners_{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};
  Vec3d normal_{0.0};  ///< Of a polygon; along a spot's axis or a sun's light.
  std::array<Vec3d, 3> sides_{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};  ///< Of a polygon, from corner 0 to the others.
  double area_ = 0.0, first_share_ = 1.0;          ///< Of a polygon, and the triangle 0 1 2 as a part of it.
  double least_cosine_ = -2.0, per_cosine_ = 1.0;  ///< How a spot's light falls off: outside a cone, and towards it.
};

}  // namespace patchlight

#include "pipeline/optics/lights/direct_light.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pipeline/optics/intersect/rounding.h"
#include "pipeline/optics/lights/sphere_form_factor.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

namespace {

constexpr int kMaxExplicit = 64;
constexpr double kMaxMasked = 0.01;    ///< Of the scene's area: a masked emitter that is sampled.
constexpr double kRounding = 0x1p-22;  ///< Of coplanar points in files, relative to their coordinates.

bool is_lit_outside(const Primitive& p) {
  return p.shape == Primitive::Shape::quad || p.sphere_radius > 0;
}

using Double4 = double __attribute__((vector_size(32)));

void load(const double* from, Double4& to) {
  std::memcpy(&to, from, sizeof to);
}

/// A polygon of up to five corners, clipped at the horizon of a point: vectors from the point, axis by axis.
struct ClippedPolygon {
  std::array<std::array<double, 9>, 3> to;
  int corners = 0;

  void add(const Vec3d& corner) {
    for (int axis = 0; axis < 3; ++axis) to[axis][corners] = corner[axis];
    ++corners;
  }

  /// Lambert's sum over the edges, once all corners are added: the angle that an edge subtends times the cosine between
  /// `normal` and the normal of the plane through edge and point. Four edges at a time, padded with the first corner.
  double close_and_sum(const Vec3d& normal) {
    // Interpolates acos(1 - x) / sqrt(1 - (1 - x)^2) on [0,1] at Chebyshev points, with an error below 5e-13.
    constexpr std::array<double, 16> kCoefficients{
        0.9999999999997928,    0.3333333334397937,  0.133333324325321,     0.05714315719271317,
        0.02539160042472899,   0.01159875513248074, 0.00495368818253234,   0.004242649723516475,
        -0.004661532338675777, 0.01449384212534609, -0.02385020820726609,  0.03011002097323368,
        -0.02614425300164627,  0.01538173800115226, -0.005444502231767958, 0.0009147130532319336};
    const int edges = corners;
    do add({to[0][0], to[1][0], to[2][0]});
    while (corners % 4 != 1);
    double all = 0;
    for (int first = 0; first < edges; first += 4) {
      Double4 ax, ay, az, bx, by, bz;
      load(&to[0][first], ax), load(&to[1][first], ay), load(&to[2][first], az);
      load(&to[0][first + 1], bx), load(&to[1][first + 1], by), load(&to[2][first + 1], bz);
      const Double4 squared = (ax * ax + ay * ay + az * az) * (bx * bx + by * by + bz * bz);
      Double4 lengths;
      for (int k = 0; k < 4; ++k) lengths[k] = std::sqrt(squared[k]);
      const Double4 inverse = 1.0 / lengths;
      const Double4 cosine = (ax * bx + ay * by + az * bz) * inverse;
      const Double4 part =
          ((by * az - bz * ay) * normal.x + (bz * ax - bx * az) * normal.y + (bx * ay - by * ax) * normal.z) * inverse;
      const Double4 off = 1.0 - (cosine < 0.0 ? -cosine : cosine);
      Double4 ratio = kCoefficients.back() - Double4{};  // angle over sine
      for (std::size_t i = kCoefficients.size() - 1; i-- > 0;) ratio = ratio * off + kCoefficients[i];
      for (int k = 0; k < 4; ++k) {
        if (cosine[k] < 0) {  // obtuse angle
          const double sine = (Vec3d(ax[k], ay[k], az[k]) % Vec3d(bx[k], by[k], bz[k])).length() * inverse[k];
          ratio[k] = sine > 0 ? kPi / sine - ratio[k] : 0.0;
        }
        all += ratio[k] * part[k];
      }
    }
    return all;
  }
};

}  // namespace

namespace {

/// A primitive that may be an emitter.
struct Candidate {
  std::int32_t first = 0, end = 0;
  double area = 0.0;
  bool uniform = true;
};

std::vector<Candidate> candidates_of(const PatchSet& scene) {
  std::vector<Candidate> candidates;
  for (std::int32_t i = 0; i < std::int32_t(scene.patches.size()); ++i) {
    const Patch& patch = scene.patches[i];
    const Primitive& primitive = scene.primitives[patch.primitive];
    if (primitive.light_group < 0 || !is_lit_outside(primitive)) continue;
    const bool begins = candidates.empty() || scene.patches[candidates.back().first].primitive != patch.primitive;
    if (begins) candidates.push_back({i, i, 0.0, true});
    Candidate& last = candidates.back();
    last.end = i + 1;
    last.area += patch.area;
    last.uniform = last.uniform && patch.emission == scene.patches[last.first].emission;
  }
  if (candidates.empty()) return candidates;
  double all = 0;
  for (const Patch& patch : scene.patches) all += patch.area;
  std::erase_if(candidates, [&](const Candidate& c) {
    const Primitive& primitive = scene.primitives[scene.patches[c.first].primitive];
    return primitive.region || (primitive.mask >= 0 && c.area > kMaxMasked * all);
  });
  return candidates;
}

}  // namespace

std::vector<Emitter> explicit_emitters(const PatchSet& scene) {
  std::vector<Candidate> candidates = candidates_of(scene);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.area > b.area; });
  std::vector<Emitter> emitters;
  for (const Candidate& c : candidates) {
    const std::int32_t primitive = scene.patches[c.first].primitive;
    const int pieces = c.uniform ? 1 : c.end - c.first;
    const bool is_quad = scene.primitives[primitive].shape == Primitive::Shape::quad;
    if (scene.primitives[primitive].mask >= 0 || (!is_quad && !c.uniform) ||
        int(emitters.size()) + pieces > kMaxExplicit)
      continue;
    if (c.uniform)
      emitters.push_back({primitive, c.first, c.end - c.first, c.area});
    else
      for (std::int32_t i = c.first; i < c.end; ++i) emitters.push_back({primitive, i, 1, scene.patches[i].area});
  }
  std::sort(emitters.begin(), emitters.end(),
            [](const Emitter& a, const Emitter& b) { return a.first_patch < b.first_patch; });
  for (std::size_t k = 0; k < scene.lights.size(); ++k)
    emitters.push_back({-1, std::int32_t(scene.patches.size()), 0, 0.0, std::int32_t(k)});
  return emitters;
}

std::vector<Emitter> further_emitters(const PatchSet& scene) {
  std::vector<std::uint8_t> is_explicit(scene.primitives.size(), 0);
  for (const Emitter& emitter : explicit_emitters(scene))
    if (emitter.primitive >= 0) is_explicit[emitter.primitive] = 1;
  std::vector<Emitter> emitters;
  for (const Candidate& c : candidates_of(scene))
    if (const std::int32_t primitive = scene.patches[c.first].primitive; is_explicit[primitive] == 0)
      emitters.push_back({primitive, c.first, c.end - c.first, c.area});
  return emitters;
}

DirectLight::DirectLight(const PatchSet& scene, const RayScene& ray_scene, const Emitter& emitter)
    : DirectLight(Vec3d(0.0), 0.0) {
  if (emitter.light >= 0) {
    const Light& light = scene.lights[emitter.light];
    *this = DirectLight(light, light.distribution < 0 ? nullptr : &scene.distributions[light.distribution]);
    return;
  }
  const Primitive& p = scene.primitives[emitter.primitive];
  kind_ = p.shape == Primitive::Shape::sphere ? Kind::sphere : Kind::polygon;
  end_offset_ = 2.0 * ray_scene.offset(emitter.primitive);
  if (kind_ == Kind::sphere) {
    center_ = p.sphere_center;
    radius_ = p.sphere_radius;
    return;
  }
  const Patch patch = emitter.patches == 1 ? scene.patches[emitter.first_patch] : Patch{};
  const auto corner = [&](double u, double v) {
    const Vec3d at = point_at(p, u, v).position;
    if (corner_count_ == 0 || (at != corners_[corner_count_ - 1] && at != corners_[0])) corners_[corner_count_++] = at;
  };
  corner(patch.u0, patch.v0);
  corner(patch.u1, patch.v0);
  corner(patch.u1, patch.v1);
  corner(patch.u0, patch.v1);
  normal_ = ((p.corners[2] - p.corners[0]) % (p.corners[3] - p.corners[1])).normalized();
  center_ = Vec3d(0.0);
  for (int k = 0; k < corner_count_; ++k) center_ += corners_[k] / double(corner_count_);
  radius_ = 0.0;
  for (int k = 0; k < corner_count_; ++k) radius_ = std::max(radius_, (corners_[k] - center_).length());
  for (int k = 1; k < corner_count_; ++k) edges_[k - 1] = corners_[k] - corners_[0];
  plane_tolerance_ = ray_scene.offset(emitter.primitive);
  for (const Vec3d& c : p.corners) plane_tolerance_ = std::max(plane_tolerance_, kRounding * absolute_dot(c, normal_));
  for (int k = 2; k < corner_count_; ++k) {
    const double before = area_;
    area_ += 0.5 * ((edges_[k - 2] % edges_[k - 1]) ^ normal_);
    if (k > 2) first_triangle_part_ = before / area_;
  }
}

DirectLight DirectLight::image(const PlaneMirror& mirror) const {
  DirectLight image = *this;
  image.center_ = mirror.image_of(center_);
  image.normal_ = mirror.reflect(normal_);
  image.across_ = mirror.reflect(across_);
  image.along_ = mirror.reflect(along_);
  for (int k = 0; k < corner_count_; ++k)  // a reflection turns the order around
    image.corners_[k] = mirror.image_of(corners_[(corner_count_ - k) % corner_count_]);
  for (int k = 1; k < corner_count_; ++k) image.edges_[k - 1] = image.corners_[k] - image.corners_[0];
  if (corner_count_ == 4) image.first_triangle_part_ = 1 - first_triangle_part_;
  return image;
}

LightBounds DirectLight::bounds() const {
  if (kind_ == Kind::polygon) return {center_, radius_, normal_, 0.0, area_};
  return {center_, radius_, Vec3d(0, 0, 1), kPi, 4 * kPi * radius_ * radius_};
}

double DirectLight::form_factor(const Vec3d& point, const Vec3f& normal) const {
  switch (kind_) {
    case Kind::polygon:
      return polygon_form_factor(point, Vec3d(normal));
    case Kind::sphere:
      return sphere_form_factor(point, Vec3d(normal));
    case Kind::disk:
      return spherical_form_factor(center_direction(point) ^ Vec3d(normal), radius_ * radius_) / (radius_ * radius_);
    case Kind::ball:
      return ball_form_factor(point, Vec3d(normal));
    default:
      return perpendicular_factor(point) * std::max(0.0, center_direction(point) ^ Vec3d(normal));
  }
}

bool DirectLight::cannot_illuminate(std::span<const Vec3d> points, const Vec3f& normal) const {
  const Vec3d up(normal);
  if (is_infinite()) return (normal_ ^ up) >= radius_;
  if (kind_ != Kind::polygon) return ((center_ - points[0]) ^ up) <= -radius_;
  const auto lit = [&](const Vec3d& point) { return height(point) > 0; };
  if (std::none_of(points.begin(), points.end(), lit)) return true;
  const auto above = [&](const Vec3d& corner) { return ((corner - points[0]) ^ up) > 0; };
  return std::none_of(corners_.begin(), corners_.begin() + corner_count_, above);
}

double DirectLight::polygon_form_factor(const Vec3d& point, const Vec3d& normal) const {
  if (height(point) <= 0) return 0.0;
  std::array<Vec3d, 5> to;
  std::array<double, 5> height;
  int above = 0;
  for (int k = 0; k < corner_count_; ++k) {
    to[k] = corners_[k] - point;
    height[k] = to[k] ^ normal;
    above += height[k] > 0;
  }
  if (above == 0) return 0.0;
  to[corner_count_] = to[0];
  height[corner_count_] = height[0];
  ClippedPolygon clipped;
  for (int k = 0; k < corner_count_; ++k) {
    if (height[k] > 0) clipped.add(to[k]);
    if (above < corner_count_ && (height[k] > 0) != (height[k + 1] > 0))
      clipped.add(to[k] + (to[k + 1] - to[k]) * (height[k] / (height[k] - height[k + 1])));
  }
  return std::max(0.0, clipped.close_and_sum(normal) / (2 * kPi));
}

double DirectLight::sphere_form_factor(const Vec3d& point, const Vec3d& normal) const {
  const Vec3d to = center_ - point;
  const double squared = to.length2();
  if (squared <= radius_ * radius_) return 0.0;
  const double ratio = radius_ * radius_ / squared;
  return spherical_form_factor(std::clamp((to ^ normal) / std::sqrt(squared), -1.0, 1.0), ratio);
}

}  // namespace patchlight

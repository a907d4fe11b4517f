#include <algorithm>
#include <cmath>

#include "pipeline/optics/lights/direct_light.h"
#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

namespace {

constexpr double kMinSolidAngle = 1e-3;   ///< sr; smaller spherical triangles are imprecise.
constexpr double kPointEndOffset = 1e-5;  ///< Relative distance from a point light at which shadow rays end.

/// A direction in a cone about an axis, uniform in solid angle; `one_minus_cos`: 1 - cosine of its half angle.
Vec3d sample_cone(const Vec3d& axis, double one_minus_cos, double x, double y) {
  const double off = y * one_minus_cos, sine = std::sqrt(off * (2 - off)), turn = 2 * kPi * x;
  Vec3f tangent, bitangent;
  orthonormal_frame(Vec3f(axis), tangent, bitangent);
  return (axis * (1 - off) + (Vec3d(tangent) * std::cos(turn) + Vec3d(bitangent) * std::sin(turn)) * sine).normalized();
}

}  // namespace

/// A spherical triangle (Arvo 1995) from directions to its corners.
DirectLight::View::Triangle::Triangle(const Vec3d& p, const Vec3d& q, const Vec3d& r)
    : a(p.normalized()), b(q.normalized()), c(r.normalized()) {
  const Vec3d ab = (a % b).normalized(), bc = (b % c).normalized(), ca = (c % a).normalized();
  const auto between = [](const Vec3d& s, const Vec3d& t) { return std::acos(std::clamp(-(s ^ t), -1.0, 1.0)); };
  angle = between(ab, ca);
  area = std::max(0.0, angle + between(ab, bc) + between(bc, ca) - kPi);
  sine = std::sin(angle);
  cosine = std::cos(angle);
  tangent = (c - a * (c ^ a)).normalized();
}

Vec3d DirectLight::View::Triangle::direction(double x, double y) const {
  const double s = std::sin(x * area - angle), t = std::cos(x * area - angle);
  const double k1 = t - cosine, k2 = s + sine * (a ^ b);
  const double below = (k2 * s + k1 * t) * sine;
  const double q = below != 0 ? std::clamp(((k2 * t - k1 * s) * cosine - k2) / below, -1.0, 1.0) : 1.0;
  const Vec3d edge = a * q + tangent * std::sqrt(1 - q * q);
  const double along = edge ^ b, z = 1 - y * (1 - along);
  return b * z + (edge - b * along).normalized() * std::sqrt(std::max(0.0, 1 - z * z));
}

DirectLight::View DirectLight::view(const Vec3d& point, const Vec3f& normal, double far) const {
  View view;
  view.light_ = this;
  view.point_ = point;
  view.normal_ = normal;
  if (kind_ != Kind::polygon) return view;
  if (height(point) <= 0) return view;
  view.height_ = (point - center_) ^ normal_;
  view.to_corner_ = corners_[0] - point;
  view.end_scale_ = float(std::max(0.0, 1 - end_offset_ / view.height_));
  if ((point - center_).length2() >= far * far * radius_ * radius_) return view;
  double all = 0;
  for (int k = 0; k + 2 < corner_count_; ++k) {
    view.triangles_[k] = View::Triangle(corners_[0] - point, corners_[k + 1] - point, corners_[k + 2] - point);
    all += view.triangles_[k].area;
  }
  if (all > kMinSolidAngle) view.solid_angle_ = all;
  return view;
}

DirectLight::Sample DirectLight::View::sample(float x, float y) const {
  switch (light_->kind_) {
    case Kind::polygon:
      return sample_polygon(x, y);
    case Kind::sphere:
      return sample_sphere(x, y);
    case Kind::disk:
      return sample_disk(x, y);
    case Kind::ball: {
      Sample sample = sample_ball(x, y);
      if (light_->is_directed_ && sample.weight > 0)
        sample.weight *= float(light_->relative_intensity(-Vec3d(sample.direction)));
      return sample;
    }
    default:
      return sample_point();
  }
}

double DirectLight::View::density(const Vec3f& direction) const {
  if (light_->is_point() || light_->kind_ == Kind::ball) return 0.0;  // no path hits it
  if (light_->kind_ == Kind::sphere || light_->kind_ == Kind::disk) {
    const double r2 = light_->radius_ * light_->radius_;
    const double sine2 = light_->kind_ == Kind::disk ? r2 : r2 / (light_->center_ - point_).length2();
    return sine2 < 1 ? (1 + std::sqrt(1 - sine2)) / (2 * kPi * sine2) : 0.0;
  }
  if (solid_angle_ > 0) return 1 / solid_angle_;
  const double slope = -(Vec3d(direction) ^ light_->normal_);
  if (slope <= 0 || height_ <= 0) return 0.0;
  const double distance = height_ / slope;
  return distance * distance / (light_->area_ * slope);
}

DirectLight::Sample DirectLight::View::sample_polygon(double x, double y) const {
  if (height_ <= 0) return {};
  Vec3f direction;
  float distance = 0, size = 0;  // sr; inverse of the density
  if (solid_angle_ > 0) {
    const double first_part = triangles_[0].area / solid_angle_;
    direction = Vec3f(x < first_part || light_->corner_count_ == 3
                          ? triangles_[0].direction(std::min(x / first_part, 1.0), y)
                          : triangles_[1].direction((x - first_part) / (1 - first_part), y));
    const double slope = -(Vec3d(direction) ^ light_->normal_);
    if (slope <= 0) return {};
    distance = float(height_ / slope);
    size = float(solid_angle_);
  } else {
    const double first_part = light_->first_triangle_part_;
    const int k = x < first_part ? 0 : 1;
    double s = k == 0 ? x / first_part : (x - first_part) / (1 - first_part), t = y;
    if (t > s) {  // Heitz 2019: maps the unit square to a triangle
      s *= 0.5;
      t -= s;
    } else {
      t *= 0.5;
      s -= t;
    }
    direction = Vec3f(to_corner_ + light_->edges_[k] * s + light_->edges_[k + 1] * t);
    const float squared = direction.length2(), inverse = 1 / std::sqrt(squared);
    direction *= inverse;
    distance = squared * inverse;
    size = float(light_->area_) * inverse * inverse * (float(height_) * inverse);
  }
  const float cosine = direction ^ normal_;
  if (!(cosine > 0)) return {};
  return {direction, distance * end_scale_, cosine * size * float(1 / kPi)};
}

DirectLight::Sample DirectLight::View::sample_sphere(double x, double y) const {
  const Vec3d to = light_->center_ - point_;
  const double radius = light_->radius_, squared = to.length2(), r2 = radius * radius;
  if (squared <= r2) return {};
  const double sine2 = r2 / squared;
  const double one_minus_cos = sine2 / (1 + std::sqrt(1 - sine2));  // without cancellation
  const Vec3d direction = sample_cone(to / std::sqrt(squared), one_minus_cos, x, y);
  const double cosine = direction ^ Vec3d(normal_);
  if (cosine <= 0) return {};
  const double half = to ^ direction, inside = r2 - (to - direction * half).length2();
  const double chord = std::sqrt(std::max(inside, 0.0));
  const double slope = std::max(chord / radius, 1e-3);
  return {Vec3f(direction), float(std::max(0.0, half - chord - light_->end_offset_ / slope)),
          float(2 * cosine * one_minus_cos)};
}

DirectLight::Sample DirectLight::View::sample_disk(double x, double y) const {
  const double sine2 = light_->radius_ * light_->radius_, one_minus_cos = sine2 / (1 + std::sqrt(1 - sine2));
  const Vec3d direction = sample_cone(light_->center_direction(point_), one_minus_cos, x, y);
  const double cosine = direction ^ Vec3d(normal_);
  if (cosine <= 0) return {};
  return {Vec3f(direction), std::numeric_limits<float>::infinity(), float(2 * cosine * one_minus_cos / sine2)};
}

/// Of a ball that emits the same in all directions. Inside, directions towards its surface, by the cosine law.
DirectLight::Sample DirectLight::View::sample_ball(double x, double y) const {
  const Vec3d to = light_->center_ - point_, normal(normal_);
  const double r2 = light_->radius_ * light_->radius_, squared = to.length2();
  const bool is_inside = squared <= r2;
  double one_minus_cos = 1.0;
  Vec3d direction;
  if (is_inside) {
    direction = sample_cone(normal, 1 - std::sqrt(1 - y), x, 1.0);
  } else {
    const double sine2 = r2 / squared;
    one_minus_cos = sine2 / (1 + std::sqrt(1 - sine2));
    direction = sample_cone(to / std::sqrt(squared), one_minus_cos, x, y);
  }
  const double cosine = direction ^ normal;
  if (cosine <= 0) return {};
  const double half = to ^ direction, chord = std::sqrt(std::max(r2 - (to - direction * half).length2(), 0.0));
  return {Vec3f(direction), float(std::max(0.0, is_inside ? half + chord : half - chord)),
          float((is_inside ? 1.0 : 2 * cosine * one_minus_cos) / r2)};
}

double DirectLight::View::perpendicular_weight(const Sample& sample) const {
  if (light_->kind_ != Kind::ball) return light_->perpendicular_factor(point_);
  return double(sample.weight) / double(sample.direction ^ normal_);
}

DirectLight::Sample DirectLight::View::sample_point() const {
  const Vec3d direction = light_->center_direction(point_);
  const double weight = light_->perpendicular_factor(point_) * (direction ^ Vec3d(normal_));
  if (!(weight > 0)) return {};
  return {Vec3f(direction), float(light_->distance(point_) * (1 - kPointEndOffset)), float(weight)};
}

}  // namespace patchlight

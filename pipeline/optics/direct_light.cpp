#include "pipeline/optics/direct_light.h"

#include <algorithm>
#include <cmath>

#include "pipeline/optics/patch_sampling.h"

namespace patchlight {

namespace {

constexpr int kMostApart = 64;
constexpr double kLeastSolidAngle = 1e-3;  ///< sr; below it spherical triangles lose their precision.

bool lit_outside(const Primitive& p) {
  return p.shape == Primitive::Shape::quad || p.sphere_radius > 0;
}

double signed_area(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& normal) {
  return 0.5 * (((b - a) % (c - a)) ^ normal);
}

}  // namespace

std::vector<Emitter> emitters_apart(const PatchSet& scene) {
  struct Candidate {
    std::int32_t first = 0, end = 0;
    double area = 0.0;
    bool even = true;
  };
  std::vector<Candidate> candidates;
  for (std::int32_t i = 0; i < std::int32_t(scene.patches.size()); ++i) {
    const Patch& patch = scene.patches[i];
    const Primitive& primitive = scene.primitives[patch.primitive];
    if (primitive.light_group < 0 || !lit_outside(primitive)) continue;
    const bool begins = candidates.empty() || scene.patches[candidates.back().first].primitive != patch.primitive;
    if (begins) candidates.push_back({i, i, 0.0, true});
    Candidate& last = candidates.back();
    last.end = i + 1;
    last.area += patch.area;
    last.even = last.even && patch.emission == scene.patches[last.first].emission;
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.area > b.area; });
  std::vector<Emitter> emitters;
  for (const Candidate& c : candidates) {
    const std::int32_t primitive = scene.patches[c.first].primitive;
    const int pieces = c.even ? 1 : c.end - c.first;
    const bool plane = scene.primitives[primitive].shape == Primitive::Shape::quad;
    if ((!plane && !c.even) || int(emitters.size()) + pieces > kMostApart) continue;
    if (c.even)
      emitters.push_back({primitive, c.first, c.end - c.first, c.area});
    else
      for (std::int32_t i = c.first; i < c.end; ++i) emitters.push_back({primitive, i, 1, scene.patches[i].area});
  }
  std::sort(emitters.begin(), emitters.end(),
            [](const Emitter& a, const Emitter& b) { return a.first_patch < b.first_patch; });
  return emitters;
}

DirectLight::DirectLight(const PatchSet& scene, const RayScene& ray_scene, const Emitter& emitter)
    : sphere_(scene.primitives[emitter.primitive].shape == Primitive::Shape::sphere),
      gap_(2.0 * ray_scene.offset(emitter.primitive)) {
  const Primitive& p = scene.primitives[emitter.primitive];
  if (sphere_) {
    center_ = p.sphere_center;
    radius_ = p.sphere_radius;
    return;
  }
  const Patch& first = scene.patches[emitter.first_patch];
  const Patch& last = scene.patches[emitter.first_patch + emitter.patches - 1];
  const auto corner = [&](double u, double v) {
    const Vec3d at = point_at(p, u, v).position;
    if (count_ == 0 || (at != corners_[count_ - 1] && at != corners_[0])) corners_[count_++] = at;
  };
  corner(first.u0, first.v0);
  corner(last.u1, first.v0);
  corner(last.u1, last.v1);
  corner(first.u0, last.v1);
  normal_ = ((p.corners[2] - p.corners[0]) % (p.corners[3] - p.corners[1])).normalized();
  center_ = Vec3d(0.0);
  for (int k = 0; k < count_; ++k) center_ += corners_[k] / double(count_);
  radius_ = 0.0;
  for (int k = 0; k < count_; ++k) radius_ = std::max(radius_, (corners_[k] - center_).length());
  for (int k = 2; k < count_; ++k) areas_[k - 2] = signed_area(corners_[0], corners_[k - 1], corners_[k], normal_);
}

double DirectLight::form_factor(const Vec3d& point, const Vec3f& normal) const {
  return sphere_ ? sphere_form_factor(point, Vec3d(normal)) : polygon_form_factor(point, Vec3d(normal));
}

bool DirectLight::is_behind(std::span<const Vec3d> points, const Vec3f& normal) const {
  const Vec3d up(normal);
  if (sphere_) return ((center_ - points[0]) ^ up) <= -radius_;
  const auto lit = [&](const Vec3d& point) { return ((point - center_) ^ normal_) > 0; };
  if (std::none_of(points.begin(), points.end(), lit)) return true;
  const auto above = [&](const Vec3d& corner) { return ((corner - points[0]) ^ up) > 0; };
  return std::none_of(corners_.begin(), corners_.begin() + count_, above);
}

double DirectLight::polygon_form_factor(const Vec3d& point, const Vec3d& normal) const {
  if (((point - center_) ^ normal_) <= 0) return 0.0;
  std::array<Vec3d, 4> to;
  std::array<double, 4> height;
  int above = 0;
  for (int k = 0; k < count_; ++k) {
    to[k] = corners_[k] - point;
    height[k] = to[k] ^ normal;
    above += height[k] > 0;
  }
  if (above == 0) return 0.0;
  std::array<Vec3d, 5> cut;
  int corners = 0;
  for (int k = 0; k < count_; ++k) {
    const int next = k + 1 < count_ ? k + 1 : 0;
    if (height[k] > 0) cut[corners++] = to[k];
    if (above < count_ && (height[k] > 0) != (height[next] > 0))
      cut[corners++] = to[k] + (to[next] - to[k]) * (height[k] / (height[k] - height[next]));
  }
  double sum = 0;
  for (int k = 0; k < corners; ++k) {
    const Vec3d& a = cut[k];
    const Vec3d& b = cut[k + 1 < corners ? k + 1 : 0];
    const Vec3d cross = b % a;
    const double sine = cross.length();
    if (sine > 0) sum += std::atan2(sine, a ^ b) / sine * (cross ^ normal);
  }
  return std::max(0.0, sum / (2 * kPi));
}

double DirectLight::sphere_form_factor(const Vec3d& point, const Vec3d& normal) const {
  const Vec3d to = center_ - point;
  const double squared = to.length2();
  if (squared <= radius_ * radius_) return 0.0;
  const double ratio = radius_ * radius_ / squared;
  const double cosine = std::clamp((to ^ normal) / std::sqrt(squared), -1.0, 1.0);
  if (cosine * cosine >= ratio) return ratio * std::max(cosine, 0.0);
  const double sine = std::sqrt(1 - cosine * cosine);
  const double x = std::sqrt(1 / ratio - 1), y = -x * cosine / sine;
  const double z = sine * std::sqrt(std::max(0.0, 1 - y * y));
  return std::max(0.0, ((cosine * std::acos(std::clamp(y, -1.0, 1.0)) - x * z) * ratio + std::atan(z / x)) / kPi);
}

/// A spherical triangle (Arvo 1995): its corners as unit vectors, the angle at the first, and its area.
DirectLight::View::Triangle::Triangle(const Vec3d& p, const Vec3d& q, const Vec3d& r)
    : a(p.normalized()), b(q.normalized()), c(r.normalized()) {
  const Vec3d ab = (a % b).normalized(), bc = (b % c).normalized(), ca = (c % a).normalized();
  const auto between = [](const Vec3d& s, const Vec3d& t) { return std::acos(std::clamp(-(s ^ t), -1.0, 1.0)); };
  angle = between(ab, ca);
  area = std::max(0.0, angle + between(ab, bc) + between(bc, ca) - kPi);
  sine = std::sin(angle);
  cosine = std::cos(angle);
  toward_c = (c - a * (c ^ a)).normalized();
}

Vec3d DirectLight::View::Triangle::direction(double x, double y) const {
  const double s = std::sin(x * area - angle), t = std::cos(x * area - angle);
  const double k1 = t - cosine, k2 = s + sine * (a ^ b);
  const double below = (k2 * s + k1 * t) * sine;
  const double q = below != 0 ? std::clamp(((k2 * t - k1 * s) * cosine - k2) / below, -1.0, 1.0) : 1.0;
  const Vec3d edge = a * q + toward_c * std::sqrt(1 - q * q);
  const double along = edge ^ b, z = 1 - y * (1 - along);
  return b * z + (edge - b * along).normalized() * std::sqrt(std::max(0.0, 1 - z * z));
}

DirectLight::View DirectLight::view(const Vec3d& point, const Vec3f& normal, double far) const {
  View view;
  view.light_ = this;
  view.point_ = point;
  view.normal_ = Vec3d(normal);
  if (sphere_) return view;
  view.height_ = (point - center_) ^ normal_;
  if (view.height_ <= 0 || (point - center_).length2() >= far * far * radius_ * radius_) return view;
  double all = 0;
  for (int k = 0; k + 2 < count_; ++k) {
    view.halves_[k] = View::Triangle(corners_[0] - point, corners_[k + 1] - point, corners_[k + 2] - point);
    all += view.halves_[k].area;
  }
  if (all > kLeastSolidAngle) view.solid_angle_ = all;
  return view;
}

DirectLight::Sample DirectLight::View::sample(float x, float y) const {
  return light_->sphere_ ? of_sphere(x, y) : of_polygon(x, y);
}

double DirectLight::View::density(const Vec3f& direction) const {
  if (light_->sphere_) {
    const double sine2 = light_->radius_ * light_->radius_ / (light_->center_ - point_).length2();
    return sine2 < 1 ? (1 + std::sqrt(1 - sine2)) / (2 * kPi * sine2) : 0.0;
  }
  if (solid_angle_ > 0) return 1 / solid_angle_;
  const double slope = -(Vec3d(direction) ^ light_->normal_);
  if (slope <= 0 || height_ <= 0) return 0.0;
  const double distance = height_ / slope;
  return distance * distance / ((light_->areas_[0] + light_->areas_[1]) * slope);
}

DirectLight::Sample DirectLight::View::of_polygon(double x, double y) const {
  if (height_ <= 0) return {};
  Vec3d direction;
  double pdf = 0;  // per solid angle
  double distance = 0;
  if (solid_angle_ > 0) {
    const double share = halves_[0].area / solid_angle_;
    direction = x < share || light_->count_ == 3 ? halves_[0].direction(std::min(x / share, 1.0), y)
                                                 : halves_[1].direction((x - share) / (1 - share), y);
    const double slope = -(direction ^ light_->normal_);
    if (slope <= 0) return {};
    distance = height_ / slope;
    pdf = 1 / solid_angle_;
  } else {
    const auto& areas = light_->areas_;
    const auto& corners = light_->corners_;
    const double all = areas[0] + areas[1], share = areas[0] / all;
    const int k = x < share ? 0 : 1;
    double s = k == 0 ? x / share : (x - share) / (1 - share), t = y;
    if (t > s) {  // Heitz 2019: the unit square onto a triangle
      s *= 0.5;
      t -= s;
    } else {
      t *= 0.5;
      s -= t;
    }
    direction = corners[0] * (1 - s - t) + corners[k + 1] * s + corners[k + 2] * t - point_;
    distance = direction.length();
    direction /= distance;
    const double slope = -(direction ^ light_->normal_);
    if (!(slope > 0)) return {};
    pdf = distance * distance / (all * slope);
  }
  const double cosine = direction ^ normal_;
  if (cosine <= 0) return {};
  const double end = std::max(0.0, distance - light_->gap_ * distance / height_);
  return {Vec3f(direction), float(end), float(cosine / (kPi * pdf))};
}

DirectLight::Sample DirectLight::View::of_sphere(double x, double y) const {
  const Vec3d to = light_->center_ - point_;
  const double radius = light_->radius_, squared = to.length2(), r2 = radius * radius;
  if (squared <= r2) return {};
  const double sine2 = r2 / squared, most = sine2 / (1 + std::sqrt(1 - sine2));  // 1 - cosine, without cancellation
  const double off = y * most, sine = std::sqrt(off * (2 - off));
  const Vec3d axis = to / std::sqrt(squared);
  Vec3f tangent, bitangent;
  orthonormal_frame(Vec3f(axis), tangent, bitangent);
  const double turn = 2 * kPi * x;
  const Vec3d direction =
      (axis * (1 - off) + (Vec3d(tangent) * std::cos(turn) + Vec3d(bitangent) * std::sin(turn)) * sine).normalized();
  const double cosine = direction ^ normal_;
  if (cosine <= 0) return {};
  const double half = to ^ direction, inside = r2 - (to - direction * half).length2();
  const double chord = std::sqrt(std::max(inside, 0.0));
  const double slope = std::max(chord / radius, 1e-3);
  return {Vec3f(direction), float(std::max(0.0, half - chord - light_->gap_ / slope)), float(2 * cosine * most)};
}

}  // namespace patchlight

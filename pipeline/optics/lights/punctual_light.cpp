#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/optics/lights/direct_light.h"
#include "pipeline/optics/lights/light_distribution.h"

namespace patchlight {

namespace {

constexpr double kMinDistance = 1e-6;  ///< m; a point light does not light closer points.
constexpr double kSmallBall = 1e-6;    ///< Squared sine of an angular radius below which the intensity hardly varies.
constexpr double kLeastPart = 0.05;    ///< Of a ball's size as seen from where its centre emits nothing to.

}  // namespace

DirectLight::DirectLight(const Light& light, const LightDistribution* distribution)
    : kind_(Kind::point), center_(light.position), normal_(light.direction) {
  if (light.kind == Light::Kind::sun) {
    kind_ = light.outer > 0 ? Kind::disk : Kind::sun;
    radius_ = std::sin(light.outer);
    return;
  }
  if (light.radius > 0) {
    kind_ = Kind::ball;
    radius_ = light.radius;
  }
  if (distribution) {
    is_directed_ = true;
    distribution_ = distribution;
    across_ = light.across;
    along_ = light.across % light.direction;
  }
  if (light.kind != Light::Kind::spot) return;
  is_directed_ = true;
  cos_outer_ = std::cos(light.outer);
  inverse_cos_range_ = 1 / std::max(0.001, std::cos(light.inner) - cos_outer_);
}

/// Unit vector towards the centre of a Light.
Vec3d DirectLight::center_direction(const Vec3d& point) const {
  return is_infinite() ? -normal_ : (center_ - point).normalized();
}

double DirectLight::relative_intensity(const Vec3d& direction) const {
  if (distribution_)
    return patchlight::relative_intensity(*distribution_,
                                          {direction ^ across_, direction ^ along_, -(direction ^ normal_)});
  const double part = std::clamp(((direction ^ normal_) - cos_outer_) * inverse_cos_range_, 0.0, 1.0);
  return part * part;
}

double DirectLight::perpendicular_factor(const Vec3d& point) const {
  if (is_infinite()) return 1.0;
  const Vec3d from = point - center_;
  const double squared = from.length2();
  if (kind_ == Kind::ball) {
    const double part = is_directed_ ? std::max(relative_intensity(from.normalized()), kLeastPart) : 1.0;
    return part / std::max(squared, radius_ * radius_);
  }
  if (squared < kMinDistance * kMinDistance) return 0.0;
  if (distribution_) return relative_intensity(from / std::sqrt(squared)) / squared;
  const double part = std::clamp(((from ^ normal_) / std::sqrt(squared) - cos_outer_) * inverse_cos_range_, 0.0, 1.0);
  return part * part / squared;
}

/// As of a sphere of uniform radiance, whose radiant intensity per strength is 1; where it depends on the direction,
/// times its mean over samples. Inside, the whole sky is as bright as the surface.
double DirectLight::ball_form_factor(const Vec3d& point, const Vec3d& normal) const {
  const double r2 = radius_ * radius_, squared = (point - center_).length2();
  const double whole = (squared > r2 ? sphere_form_factor(point, normal) : 1.0) / r2;
  if (!is_directed_ || whole <= 0) return whole;
  if (r2 < kSmallBall * squared) return whole * relative_intensity((point - center_).normalized());
  const View view = this->view(point, Vec3f(normal));
  const auto mean = [&](int count, auto place) {
    double sum = 0, weights = 0;
    for (int k = 0; k < count; ++k) {
      const auto [x, y] = place(k);
      const Sample sample = view.sample_ball(x, y);
      if (sample.weight <= 0) continue;
      sum += double(sample.weight) * relative_intensity(-Vec3d(sample.direction));
      weights += double(sample.weight);
    }
    return weights > 0 ? sum / weights : 0.0;
  };
  const auto mean_of_rings = [&](int rings) {  // without error of the first order
    return mean(6 * rings, [=](int k) { return std::pair((k % 6 + 0.5 * (k / 6)) / 6, (k / 6 + 0.5) / rings); });
  };
  constexpr double kMaxDifference = 0.005;  // of two means of a few points, for which these are enough
  const double coarse = mean_of_rings(2);
  const bool is_even = std::abs(mean_of_rings(1) - coarse) <= kMaxDifference * coarse;
  if (is_even && !is_at_edge_of_cone(point)) return whole * coarse;
  constexpr int kPoints = 233, kStep = 144;  // of a Fibonacci lattice
  return whole *
         mean(kPoints, [](int k) { return std::pair((k * kStep % kPoints + 0.5) / kPoints, (k + 0.5) / kPoints); });
}

/// Whether a point of a ball with a cone is inside of the cone as seen from `point`, and another one outside.
bool DirectLight::is_at_edge_of_cone(const Vec3d& point) const {
  if (distribution_) return false;
  const Vec3d from = point - center_;
  const double distance = from.length();
  if (distance <= radius_) return true;
  const double angle = std::acos(std::clamp((from ^ normal_) / distance, -1.0, 1.0));
  const double radius = std::asin(radius_ / distance), outer = std::acos(cos_outer_);
  return std::abs(angle - outer) < radius;
}

}  // namespace patchlight

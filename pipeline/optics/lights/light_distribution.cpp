#include "pipeline/optics/lights/light_distribution.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

constexpr double kAngleRounding = 1e-7;  ///< Degrees; of directions, beyond the first and the last angle.

/// A place between two angles of a table.
struct Place {
  std::size_t low = 0, high = 0;
  double part = 0.0;  ///< Of `high`.
  bool outside = false;
};

Place place_of(double angle, const std::vector<double>& angles) {
  if (angles.size() == 1) return {};
  if (angle < angles.front() - kAngleRounding || angle > angles.back() + kAngleRounding) return {0, 0, 0.0, true};
  const auto above = std::upper_bound(angles.begin(), angles.end(), angle) - angles.begin();
  const std::size_t high = std::clamp<std::size_t>(std::size_t(above), 1, angles.size() - 1);
  const double step = angles[high] - angles[high - 1];
  return {high - 1, high, std::clamp((angle - angles[high - 1]) / step, 0.0, 1.0), false};
}

}  // namespace

double relative_intensity(const LightDistribution& table, const Vec3d& d) {
  const auto degrees = [](double radians) { return radians * (180 / kPi); };
  double vertical = 0, horizontal = 0;
  switch (table.system) {
    case LightDistribution::System::c:
      vertical = degrees(std::atan2(std::hypot(d.x, d.y), -d.z));
      if (table.horizontal.size() > 1) horizontal = degrees(std::atan2(d.y, d.x));
      if (horizontal < 0) horizontal += 360;
      break;
    case LightDistribution::System::b:
      vertical = degrees(std::atan2(d.x, -d.z));
      horizontal = degrees(std::atan2(-d.y, std::hypot(d.x, d.z)));
      break;
    case LightDistribution::System::a:
      vertical = degrees(std::atan2(d.y, std::hypot(d.x, d.z)));
      horizontal = degrees(std::atan2(d.x, -d.z));
      break;
  }
  const Place v = place_of(vertical, table.vertical), h = place_of(horizontal, table.horizontal);
  const bool is_only_angle = table.vertical.size() > 1 || std::abs(vertical - table.vertical[0]) <= kAngleRounding;
  if (v.outside || h.outside || !is_only_angle) return 0.0;
  const auto at = [&](std::size_t column) {
    const float* values = table.intensity.data() + column * table.vertical.size();
    return double(values[v.low]) + (double(values[v.high]) - double(values[v.low])) * v.part;
  };
  const double low = at(h.low);
  return h.part > 0 ? low + (at(h.high) - low) * h.part : low;
}

}  // namespace patchlight

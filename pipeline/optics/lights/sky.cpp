#include "pipeline/optics/lights/sky.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

/// Azimuth in full turns from -X over -Z, in [0,1): the horizontal coordinate of an equirectangular image.
double azimuth(const Vec3f& d) {
  const double part = 0.5 + std::atan2(double(d.z), double(d.x)) / (2 * kPi);
  return part < 1 ? part : 0.0;
}

/// x mod 1.
double fraction(double x) {
  return x - std::floor(x);
}

}  // namespace

Vec2f texel_at(const Environment& sky, const Vec3f& d) {
  const double height = std::atan2(double(d.y), std::hypot(double(d.x), double(d.z)));
  return {float(fraction(azimuth(d) + sky.turn) * sky.width), float((0.5 - height / kPi) * sky.height)};
}

Vec3d direction_at(const Environment& sky, double x, double y) {
  const double turn = 2 * kPi * (x / sky.width - sky.turn - 0.5), height = kPi * (0.5 - y / sky.height);
  return {std::cos(height) * std::cos(turn), std::sin(height), std::cos(height) * std::sin(turn)};
}

Color sky_radiance(const Environment& sky, const Vec3f& direction) {
  if (sky.texels.size() == 1) return sky.texels[0];
  const Vec2f at = texel_at(sky, direction) - Vec2f(0.5f);
  const float x = std::floor(at.x), y = std::floor(at.y);
  const auto texel = [&](int column, int row) {
    column = (column + sky.width) % sky.width;
    return sky.texels[std::size_t(std::clamp(row, 0, sky.height - 1)) * std::size_t(sky.width) + std::size_t(column)];
  };
  const int column = int(x), row = int(y);
  const float right = at.x - x, down = at.y - y;
  return (texel(column, row) * (1 - right) + texel(column + 1, row) * right) * (1 - down) +
         (texel(column, row + 1) * (1 - right) + texel(column + 1, row + 1) * right) * down;
}

Color clipped(const Environment& sky, const Color& radiance) {
  const float max_channel = std::max({radiance.x, radiance.y, radiance.z});
  return sky.clip > 0 && max_channel > sky.clip ? radiance * (sky.clip / max_channel) : radiance;
}

Color clipped_radiance(const Environment& sky, const Vec3f& direction) {
  return clipped(sky, sky_radiance(sky, direction));
}

std::int32_t sky_cell(const Environment& sky, const Vec3f& direction) {
  if (sky.rows == 1) return 0;
  const int columns = 2 * sky.rows;
  const double height = double(direction.y) / double(direction.length());
  const int row = std::clamp(int((1 - height) * 0.5 * sky.rows), 0, sky.rows - 1);
  return row * columns + std::min(int(azimuth(direction) * columns), columns - 1);
}

}  // namespace patchlight

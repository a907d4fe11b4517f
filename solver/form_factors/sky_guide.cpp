#include "solver/form_factors/sky_guide.h"

#include <cmath>

#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

namespace {

constexpr float kLoneReach = 1.0f / 32;     // of a single known direction
constexpr float kDirectionsPerStep = 2.0f;  // of the reach, along the side of their rectangle, squared

/// Turns in [0,1); `turns` is small.
float wrapped(float turns) {
  const float rest = turns - float(int(turns));
  return rest >= 0.0f ? rest : rest + 1.0f < 1.0f ? rest + 1.0f : 0.0f;
}

/// Where the longest arc without known directions ends, in turns.
float first_azimuth(std::span<const Vec2f> known) {
  constexpr int kArcs = 64;
  std::array<bool, kArcs> taken{};
  for (const Vec2f& at : known) taken[std::min(int(at.y * kArcs), kArcs - 1)] = true;
  int best = 0, longest = 0, empty = 0;
  for (int k = 0; k < 2 * kArcs; ++k) {
    empty = taken[k % kArcs] ? 0 : empty + 1;
    if (empty > longest) longest = empty, best = (k + 1) % kArcs;
  }
  return float(best) / kArcs;
}

}  // namespace

SkyGuide::SkyGuide(std::span<const Vec2f> known) {
  const float start = first_azimuth(known);
  Vec2f low(1.0f, 1.0f), high(0.0f, 0.0f);
  for (const Vec2f& at : known) {
    const Vec2f turned(at.x, wrapped(at.y - start));
    low = Vec2f(std::min(low.x, turned.x), std::min(low.y, turned.y));
    high = Vec2f(std::max(high.x, turned.x), std::max(high.y, turned.y));
  }
  // The more are known, the less far beyond them.
  const float steps = std::max(1.0f, std::sqrt(float(known.size()) / kDirectionsPerStep));
  const auto reach = [&](float from, float to) { return std::max(to - from, kLoneReach) / steps; };
  const Vec2f around(reach(low.x, high.x), reach(low.y, high.y));
  low_ = Vec2f(std::max(0.0f, low.x - around.x), low.y - around.y);
  size_ = Vec2f(std::min(1.0f, high.x + around.x) - low_.x, std::min(1.0f, high.y + around.y - low_.y));
  const Vec2f scale(1.0f / size_.x, 1.0f / size_.y);
  for (const Vec2f& at : known) cells_.add((Vec2f(at.x, wrapped(at.y - start)) - low_) * scale);
  const auto cells = [](float part) {
    return std::min(int(std::ceil(part * VisibleCells::kSide)), VisibleCells::kSide - 1);
  };
  cells_.widen(cells(around.x * scale.x), cells(around.y * scale.y));
  sampler_.emplace(cells_);
  low_.y += start;
}

bool SkyGuide::contains(const Vec2f& at) const {
  const Vec2f inside((at.x - low_.x) / size_.x, wrapped(at.y - low_.y) / size_.y);
  return inside.x >= 0 && inside.x < 1 && inside.y < 1 && cells_.contains(inside);
}

Vec2f SkyGuide::point(const Vec2f& at) const {
  const Vec2f inside = (*sampler_)(at);
  return {std::min(low_.x + inside.x * size_.x, 1.0f), wrapped(low_.y + inside.y * size_.y)};
}

Vec2f turned_direction(const Vec2f& at, const Vec3f& from, const Vec3f& to) {
  Vec3f tangent, bitangent;
  orthonormal_frame(from, tangent, bitangent);
  const Vec3f about = cosine_direction(at.x, at.y);
  const Vec3f direction = tangent * about.x + bitangent * about.y + from * about.z;
  const float cosine = direction ^ to;
  orthonormal_frame(to, tangent, bitangent);
  const float turns = std::atan2(direction ^ bitangent, direction ^ tangent) / float(2 * kPi);
  return {cosine < 0 ? 2.0f : std::clamp(1.0f - cosine * cosine, 0.0f, 1.0f), wrapped(turns)};
}

}  // namespace patchlight

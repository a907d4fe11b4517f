#pragma once
#include <array>

#include "pipeline/optics/lights/direct_light.h"

namespace patchlight {

/// What samples of an emitter say of how much of it is seen.
struct LightSamples {
  int count = 0;
  int visible = 0;
  int hidden = 0;       ///< Neither for what lies behind the emitter or below the horizon.
  double seen = 0.0;    ///< Weights of what is visible.
  double missed = 0.0;  ///< Weights of what is hidden.

  /// Two estimates of the form factor: the better one of little that is seen, and, from the closed form `whole`, the
  /// better one of little that is hidden.
  double from_seen() const { return seen / count; }
  double from_hidden(double whole) const { return whole - missed / count; }
};

/// How many samples, from places around, see an emitter.
struct Visibility {
  int visible = 0, hidden = 0;

  void add(const LightSamples& samples) {
    visible += samples.visible;
    hidden += samples.hidden;
  }
  bool partial() const { return visible > 0 && hidden > 0; }
  /// In [0,1]; all of it where nobody looked.
  float part_seen() const { return visible + hidden > 0 ? float(visible) / float(visible + hidden) : 1.0f; }
  bool mostly_seen() const { return visible >= hidden; }
};

/// Shadow rays from anywhere, cast as soon as they fill a packet. What add() is given must live until then.
class ShadowRays {
 public:
  explicit ShadowRays(const RayScene& scene) : scene_(scene) {}

  /// Casts a ray for `sample`, seen from `start`, and counts it in `sums`.
  void add(const Vec3d& start, const DirectLight::Sample& sample, LightSamples& sums);

  /// Casts what is left.
  void cast();

 private:
  const RayScene& scene_;
  RayPacket packet_;
  std::array<float, RayPacket::kSize> weights_{};
  std::array<LightSamples*, RayPacket::kSize> sums_{};
  int lanes_ = 0;
};

}  // namespace patchlight

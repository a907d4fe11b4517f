#pragma once
#include <array>

#include "pipeline/optics/lights/direct_light.h"

namespace patchlight {

/// Shadow ray statistics of one emitter.
struct LightSamples {
  int count = 0;        ///< All samples.
  int visible = 0;      ///< Samples that reach the emitter.
  int hidden = 0;       ///< Occluded samples. Samples of weight 0 are neither visible nor hidden.
  double seen = 0.0;    ///< Sum of the weights of visible samples.
  double missed = 0.0;  ///< Sum of the weights of occluded samples.
  Vec2f reached{0.0f};  ///< In the unit square: a sample that reaches the emitter.
  int dimmed = 0;       ///< Visible samples of which much is lost.
  Vec3d lost{0.0};      ///< Part of `seen` that surfaces on the way do not let pass.

  /// Two estimates of the form factor. estimate_from_visible() has less noise if little is visible;
  /// estimate_from_hidden(), which subtracts from the unoccluded form factor `whole`, if little is hidden.
  double estimate_from_visible() const { return seen / count; }
  double estimate_from_hidden(double whole) const { return whole - missed / count; }

  /// Counts what other samples reach as well, for tint().
  void add_light(const LightSamples& other) {
    seen += other.seen;
    lost += other.lost;
  }

  /// What surfaces on the way let pass of the light of the visible part; 1 without samples.
  Color tint() const { return seen > 0 ? Color(Vec3d(1.0) - lost / seen) : Color(1.0f); }
};

/// Numbers of samples from neighbouring points that reach an emitter, or are occluded.
struct Visibility {
  int visible = 0, hidden = 0;
  int dimmed = 0;  ///< Of the visible ones.

  /// Adds the numbers of LightSamples or of another Visibility.
  template <class Samples>
  void add(const Samples& samples) {
    visible += samples.visible;
    hidden += samples.hidden;
    dimmed += samples.dimmed;
  }
  bool partial() const { return visible > 0 && (hidden > 0 || (dimmed > 0 && dimmed < visible)); }
  /// Visible fraction, in [0,1]; 1 without samples.
  float visible_fraction() const { return visible + hidden > 0 ? float(visible) / float(visible + hidden) : 1.0f; }
  /// Without samples nothing is known to be visible.
  bool mostly_visible() const { return visible > 0 && visible >= hidden; }
};

/// Collects shadow rays, straight or by a mirror to a virtual image, and casts them in full packets. The sums passed to
/// add() must outlive the next cast().
class ShadowRays {
 public:
  explicit ShadowRays(const RayScene& scene, const PlaneMirror* mirror = nullptr) : scene_(scene), mirror_(mirror) {}

  /// Adds a shadow ray from `start` for `sample`, by the point `at` of the unit square; its cast updates `sums`.
  void add(const Vec3d& start, const DirectLight::Sample& sample, const Vec2f& at, LightSamples& sums);

  /// Casts the remaining rays.
  void cast();

 private:
  void dim(std::uint32_t visible) const;

  const RayScene& scene_;
  const PlaneMirror* const mirror_;
  RayPacket packet_;
  RayPacket reflected_;  ///< From the mirror.
  std::array<float, RayPacket::kSize> weights_{};
  std::array<Vec2f, RayPacket::kSize> at_{};
  std::array<LightSamples*, RayPacket::kSize> sums_{};
  int lanes_ = 0;
};

}  // namespace patchlight

#include "pipeline/optics/lights/shadow_rays.h"

#include <algorithm>

namespace patchlight {

void ShadowRays::add(const Vec3d& start, const DirectLight::Sample& sample, const Vec2f& at, LightSamples& sums) {
  if (mirror_) {
    const auto crossing = mirror_->crossing(start, sample.direction);
    if (!crossing || crossing->leaves >= sample.distance) {
      ++sums.hidden;
      sums.missed += sample.weight;
      return;
    }
    packet_.set_shadow(lanes_, scene_.to_local(start), sample.direction, crossing->arrives);
    reflected_.set_shadow(lanes_, scene_.to_local(crossing->position), crossing->direction,
                          sample.distance - crossing->leaves);
  } else {
    packet_.set_shadow(lanes_, scene_.to_local(start), sample.direction, sample.distance);
  }
  weights_[lanes_] = sample.weight;
  at_[lanes_] = at;
  sums_[lanes_++] = &sums;
  if (lanes_ == RayPacket::kSize) cast();
}

void ShadowRays::cast() {
  if (lanes_ == 0) return;
  for (int lane = lanes_; lane < RayPacket::kSize; ++lane) packet_.valid[lane] = 0;
  std::uint32_t occluded_lanes = scene_.occluded(packet_);
  if (mirror_) {
    for (int lane = 0; lane < RayPacket::kSize; ++lane)
      reflected_.valid[lane] = occluded_lanes >> lane & 1u ? 0 : packet_.valid[lane];
    occluded_lanes |= scene_.occluded(reflected_);
  }
  if (scene_.has_passable()) dim(~occluded_lanes & ((1u << lanes_) - 1));
  for (int lane = 0; lane < lanes_; ++lane) {
    const bool visible = !(occluded_lanes >> lane & 1u);
    ++(visible ? sums_[lane]->visible : sums_[lane]->hidden);
    (visible ? sums_[lane]->seen : sums_[lane]->missed) += weights_[lane];
    if (visible) sums_[lane]->reached = at_[lane];
  }
  lanes_ = 0;
}

/// Takes account of surfaces on the way of visible lanes that let light pass.
void ShadowRays::dim(std::uint32_t visible) const {
  constexpr float kBright = 0.75f;
  RayScene::Transmittances passed = scene_.transmittances(packet_, visible);
  if (mirror_) {
    const RayScene::Transmittances reflected = scene_.transmittances(reflected_, visible);
    for (int lane = 0; lane < lanes_; ++lane) passed[lane] *= reflected[lane];
  }
  for (int lane = 0; lane < lanes_; ++lane) {
    if (!(visible >> lane & 1u)) continue;
    sums_[lane]->lost += Vec3d(Color(1.0f) - passed[lane]) * double(weights_[lane]);
    sums_[lane]->dimmed += std::min({passed[lane].x, passed[lane].y, passed[lane].z}) < kBright;
  }
}

}  // namespace patchlight

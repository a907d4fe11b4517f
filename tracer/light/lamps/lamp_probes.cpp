#include "tracer/light/lamps/lamp_probes.h"

namespace patchlight {

namespace {

constexpr int kMinProbes = 8;  // of one surface, below which those of other surfaces count too

}  // namespace

void LampProbes::add(const std::vector<LightSamples>& probes, bool with_tints) {
  std::uint32_t& reaching = reaching_.emplace_back(0);
  for (const LightSamples& probe : probes) {
    counts_.push_back({std::uint8_t(probe.visible), std::uint8_t(probe.hidden), std::uint8_t(probe.dimmed)});
    reaching += probe.visible > 0;
  }
  for (std::size_t s = 0; with_tints && s < probes.size(); ++s) {
    LightSamples near;
    for (const std::int32_t t : clusters_.neighbours()[s])
      if (t >= 0) near.add_light(probes[std::size_t(t)]);
    tints_.push_back(near.tint());
  }
}

LampProbes::Local LampProbes::around(std::size_t lamp, std::size_t cluster) const {
  const Counts* counts = counts_.data() + lamp * clusters_.size();
  Visibility same;
  bool lit = false, dark = false;
  for (const std::int32_t s : clusters_.neighbours()[cluster]) {
    if (s < 0) continue;
    lit = lit || (counts[s].hidden == 0 && counts[s].visible > 0);
    dark = dark || (counts[s].visible == 0 && counts[s].hidden > 0);
    if (std::size_t(s) != cluster) same.add(counts[s]);
  }
  if (same.visible + same.hidden < kMinProbes) {
    same = around_pixel(lamp, clusters_[cluster].pixel);
    same.visible -= counts[cluster].visible;
    same.hidden -= counts[cluster].hidden;
    same.dimmed -= counts[cluster].dimmed;
  }
  return {same, lit && dark};
}

Visibility LampProbes::around_pixel(std::size_t lamp, std::uint32_t pixel) const {
  const Counts* counts = counts_.data() + lamp * clusters_.size();
  Visibility all;
  clusters_.for_each_around(pixel, [&](std::uint32_t s) { all.add(counts[s]); });
  return all;
}

Visibility LampProbes::of(std::size_t lamp, std::size_t cluster) const {
  Visibility result;
  result.add(counts_[lamp * clusters_.size() + cluster]);
  return result;
}

}  // namespace patchlight

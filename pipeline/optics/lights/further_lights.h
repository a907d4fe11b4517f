#pragma once
#include <optional>
#include <span>
#include <vector>

#include "pipeline/optics/lights/direct_light.h"
#include "pipeline/optics/lights/light_tree.h"
#include "pipeline/optics/sampling/patch_lookup.h"

namespace patchlight {

/// The emitters of a scene beyond its explicit_emitters(), in a LightTree that chooses some of them for each receiver.
/// The scene must outlive it.
class FurtherLights {
 public:
  /// `emitters`: see further_emitters(). `strengths`, one for each, are factors of their importance; empty: it depends
  /// on geometry alone.
  FurtherLights(const PatchSet& scene, const RayScene& ray_scene, std::vector<Emitter> emitters,
                std::span<const float> strengths = {});

  bool empty() const { return emitters_.empty(); }
  const std::vector<Emitter>& emitters() const { return emitters_; }
  const DirectLight& light(std::int32_t i) const { return lights_[i]; }
  const LightTree& tree() const { return tree_; }  ///< Its emitters are indices of emitters().

  /// The patch of emitter `i` that a shadow ray from `start` reaches; -1: the alpha mask lets it pass.
  std::int32_t patch_at(std::int32_t i, const Vec3d& start, const DirectLight::Sample& ray) const;

 private:
  const PatchSet& scene_;
  const std::vector<Emitter> emitters_;
  const std::vector<DirectLight> lights_;
  const LightTree tree_;
  std::optional<const PatchLookup> lookup_;  ///< If an emitter has several patches.
};

}  // namespace patchlight

#pragma once
#include <array>
#include <functional>
#include <span>

#include "pipeline/model/transport.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/lights/direct_light.h"
#include "pipeline/optics/sampling/patch_lookup.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// Form factors from patches to emitters, apart from the rows: closed forms where an emitter is wholly visible, samples
/// where it is not.
///
/// Each half of a row takes a few samples of an emitter, stratified jointly over patch and emitter, and many more where
/// samples near it disagree about visibility; those of the half itself have no say in that, nor in whether it is what
/// is seen or what is hidden that is sampled, so that every half is unbiased.
class DirectFactors {
 public:
  /// Puts up to 16 indices into `near` and returns how many.
  using Near = std::array<std::int32_t, 16>;
  using Neighbours = std::function<int(std::int32_t, Near& near)>;

  /// From `receivers`, the patches of a scene or parts of them. `neighbours` names those about one of them.
  DirectFactors(const PatchSet& scene, const RayScene& ray_scene, std::span<const Patch> receivers,
                Neighbours neighbours, std::uint64_t seed)
      : scene_(scene), ray_scene_(ray_scene), receivers_(receivers), neighbours_(std::move(neighbours)), seed_(seed) {}

  /// Form factors to `emitter`, one of `emitters`, with the accuracy that `rays` a row ask for. The same for any number
  /// of threads.
  /// Adds the number of rays cast to `cast`. Throws: Error (interrupted).
  Transport::Emitter sample(const Emitter& emitter, std::size_t emitters, int rays, std::int64_t& cast) const;

 private:
  class Run;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const std::span<const Patch> receivers_;
  const Neighbours neighbours_;
  std::uint64_t seed_;
};

/// The patches about a patch on its primitive's grid; on a sphere, on its ring and the next.
DirectFactors::Neighbours grid_neighbours(const PatchSet& scene, const PatchLookup& lookup);

}  // namespace patchlight

#pragma once
#include "pipeline/model/transport.h"
#include "pipeline/optics/direct_light.h"
#include "pipeline/optics/patch_lookup.h"
#include "pipeline/optics/ray_scene.h"
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
  DirectFactors(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup, std::uint64_t seed)
      : scene_(scene), ray_scene_(ray_scene), lookup_(lookup), seed_(seed) {}

  /// Form factors to `emitter`, one of `emitters`, with the accuracy that `rays` a row ask for. The same for any number
  /// of threads.
  /// Adds the number of rays cast to `cast`. Throws: Error (interrupted).
  Transport::Emitter sample(const Emitter& emitter, std::size_t emitters, int rays, std::int64_t& cast) const;

 private:
  class Run;

  template <class Act>
  void for_each_neighbour(std::int32_t i, Act act) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const PatchLookup& lookup_;
  std::uint64_t seed_;
};

}  // namespace patchlight

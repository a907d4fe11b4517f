#pragma once
#include <array>
#include <functional>
#include <span>

#include "pipeline/model/transport.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/lights/direct_light.h"
#include "pipeline/optics/surface/lattices.h"
#include "pipeline/stage/progress.h"
#include "solver/form_factors/visible_density.h"

namespace patchlight {

/// Distance in radii of an emitter beyond which it is sampled by area instead of solid angle: there visibility varies
/// more than the form factors of the emitter's parts.
constexpr double kAreaSamplingDistance = 1.5;

/// Form factors from patches to explicitly sampled emitters: closed forms where an emitter is wholly visible, shadow
/// rays where it is partly hidden.
///
/// Each sample set of a row takes a few samples, stratified jointly over patch and emitter, and many more where nearby
/// samples disagree about visibility. A set's own samples decide neither its sample count nor its estimator, so every
/// set is unbiased.
class DirectFactors {
 public:
  using NeighbourList = std::array<std::int32_t, 16>;
  /// Fills the list with the neighbours of a receiver and returns their number, at most 16.
  using FindNeighbours = std::function<int(std::int32_t, NeighbourList&)>;

  /// `receivers`: the patches of a scene, or parts of them. `densities`: of points over the receivers; must outlive
  /// this object.
  DirectFactors(const PatchSet& scene, const RayScene& ray_scene, std::span<const Patch> receivers,
                FindNeighbours find_neighbours, std::uint64_t seed, const VisibleDensities& densities = kUniform)
      : scene_(scene),
        ray_scene_(ray_scene),
        receivers_(receivers),
        find_neighbours_(std::move(find_neighbours)),
        seed_(seed),
        densities_(densities) {}

  /// Form factors to `emitter`, one of `emitters`. The number of samples is proportional to `rays`, the rays of a row.
  /// The result does not depend on the number of threads. Adds the number of rays to `cast`.
  /// Throws: Error (interrupted).
  Transport::Emitter sample(const Emitter& emitter, std::size_t emitters, int rays, std::int64_t& cast) const;

  /// The same to the virtual image of an emitter in a perfect mirror, one of `images`, as far as the mirror shows it.
  /// Times what surfaces on the way let pass. Shape: [2 receivers]: [receiver][sample set].
  std::vector<Color> sample_image(const Emitter& emitter, const PlaneMirror& mirror, std::size_t images, int rays,
                                  std::int64_t& cast) const;

 private:
  class EmitterSampler;

  inline static const VisibleDensities kUniform{};

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const std::span<const Patch> receivers_;
  const FindNeighbours find_neighbours_;
  std::uint64_t seed_;
  const VisibleDensities& densities_;
};

/// Finds the patches next to a patch in the grid of its primitive or in one that continues it; on a sphere, in its ring
/// and the adjacent rings. `also_behind`: also those of the grid behind something that stands between them.
DirectFactors::FindNeighbours grid_neighbours(const PatchSet& scene, const PatchLookup& lookup,
                                              const Lattices& lattices, bool also_behind = false);

}  // namespace patchlight

#pragma once
#include <span>

#include "pipeline/model/shard.h"
#include "pipeline/model/transport.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/transport/elements.h"
#include "pipeline/stage/progress.h"
#include "solver/form_factors/direction_table.h"
#include "solver/form_factors/harmonic_distance.h"

namespace patchlight {

/// Rows of form factors by rays: of a patch's rays, leaving it uniformly over its area and with the density cos / pi
/// over the hemisphere, the part that ends on patch j estimates F_ij without bias (Malley 1988). Both halves of a row
/// are sets of Sobol points, scrambled at random by exclusive or for each patch and half, or both for each patch
/// together: better as a whole, but their difference tells nothing then.
///
/// A ray that meets a metal goes on, and what it meets then counts by what the metals on its way reflect, after
/// Russian roulette: extended form factors (Sillion and Puech 1989).
class RayRows {
 public:
  enum class SampleSets { separate, together };

  /// Of `receivers`, patches of the scene's primitives or, of no size, points of them, to `elements`.
  /// Where `visible_fractions`, rows of patches that are exposed in part alone are of that part.
  RayRows(const PatchSet& scene, const RayScene& ray_scene, std::span<const Patch> receivers, const Elements& elements,
          std::uint64_t seed, SampleSets sets, bool visible_fractions = false);

  /// Sets `to`, with `rays` a row, rounded up to a multiple of 32; up to eight times as many where most meet nothing,
  /// so that what a row does see is no noisier. The same for any number of threads. Returns how many rays were cast,
  /// those behind mirrors included. `shard`: rows of its part of the receivers alone, numbered from its first.
  /// Throws: Error (interrupted).
  std::int64_t cast(int rays, TransportRows& to, Progress& progress, Shard shard = {}) const;

 private:
  struct SampleSet;
  struct Scratch;

  /// What a thread's rows have met, row after row and half after half.
  struct Found {
    std::vector<std::int32_t> columns, hits;
    std::vector<float> hit_weights, visible_fractions;
    std::vector<TransportRows::Mirrored> mirrored;
    std::int64_t rays = 0;
  };

  void cast_row(std::int32_t row, const DirectionTable& table, Scratch& scratch, Found& found) const;
  void cast_block(SampleSet& set, const DirectionTable& table, int block) const;
  void start_packet(const SampleSet& set, const DirectionTable& table, int first, RayPacket& packet) const;
  void follow_mirrors(SampleSet& set, int first, RayPacket& packet) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const std::span<const Patch> receivers_;
  const Elements& elements_;
  std::uint64_t seed_;
  const bool visible_fractions_;
  const bool separate_;
  std::vector<char> metallic_;  ///< By primitive.
  bool has_metals_ = false;
};

}  // namespace patchlight

#pragma once
#include <optional>
#include <span>

#include "pipeline/job/shard.h"
#include "pipeline/model/transport.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "pipeline/optics/transport/elements.h"
#include "pipeline/optics/transport/glass_path.h"
#include "pipeline/stage/progress.h"
#include "solver/form_factors/direction_table.h"
#include "solver/form_factors/harmonic_distance.h"
#include "solver/form_factors/quad_rays.h"
#include "solver/form_factors/sky_guide.h"

namespace patchlight {

/// Rows of form factors by ray casting: the fraction of a patch's rays that hit patch j is an unbiased estimate of F_ij
/// (Malley 1988). Origins are uniform over the patch's area, directions have the density cos / pi. A row has two sample
/// sets of Sobol points, each with its own random digital shift, so that their difference estimates the error.
///
/// Metals reflect rays; the elements hit afterwards are weighted by the specular reflectances on the path, after
/// Russian roulette: extended form factors (Sillion and Puech 1989). Coats reflect rays with their probability, or let
/// them pass to the diffuse part: see passes_by_chance(). So does glass, which refracts them or lets them pass
/// straight, and what covers a place in part lets them pass with the probability of the rest.
///
/// Where a sample set finds the environment by less than a quarter of its rays, as through a window, the other set
/// casts as many rays again, from points four times as many, by a SkyGuide to what the first set of this row and of its
/// neighbours found: so a set's guide does not depend on its own rays, and its mean stays unbiased. Hits in these
/// directions, by rays of either kind, have the weights of the balance heuristic (Veach and Guibas 1995); the rest of
/// the hemisphere is shared out among all other rays, so that form factors of an open row still add up to 1.
class RayRows {
 public:
  /// From `receivers`, patches of the scene's primitives or points (patches of no size), to `elements`.
  /// `visible_fractions`: whether form factors of partly covered patches are those of their visible part: see
  /// VisibleDensity. `ray_factors`: how many times as many rays each receiver casts at least, or kQuarter; empty: 1.
  RayRows(const PatchSet& scene, const RayScene& ray_scene, std::span<const Patch> receivers, const Elements& elements,
          std::uint64_t seed, bool visible_fractions = false, std::span<const std::uint8_t> ray_factors = {});

  /// Sets `rows` from `rays` rays a row, rounded up to a multiple of 32; up to eight times as many where most rays hit
  /// nothing, so that sparse rows are no noisier; a quarter for patches that are far smaller than the target of their
  /// scale, whose noise hardly matters. The result does not depend on the number of threads.
  /// `shard`: casts only its part of the receivers, numbered from its first. Returns the number of rays cast, reflected
  /// ones included. Throws: Error (interrupted).
  std::int64_t cast(int rays, TransportRows& rows, Progress& progress, Shard shard = {}) const;

  static constexpr std::uint8_t kQuarter = 0;  ///< A ray factor: a quarter.

 private:
  struct SampleSet;
  struct Scratch;
  struct RowBlock;
  struct SkyRow;
  struct Tables;

  std::vector<RowBlock> row_blocks(std::int32_t first, std::int32_t last) const;
  static void append(std::span<const RowBlock> blocks, std::int32_t start, TransportRows& rows);
  void cast_row(std::int32_t row, const Tables& tables, Scratch& scratch, RowBlock& result) const;
  void cast_block(SampleSet& set, const DirectionTable& table, int block) const;
  void start_packet(const SampleSet& set, QuadSamples& samples, int first, RayPacket& packet) const;
  /// The least number of a row's blocks.
  int least_blocks(std::int32_t row) const {
    return ray_factors_.empty() || ray_factors_[row] == kQuarter ? 1 : ray_factors_[row];
  }
  std::int32_t certain_element(const RayPacket& packet, int lane, SurfaceHit hit) const;
  struct Reflections;
  void meet(SampleSet& set, const DirectionTable& table, int first, int lane, RayPacket& packet,
            Reflections& reflections) const;
  void pass_surfaces(SampleSet& set, const DirectionTable& table, int first, RayPacket& packet,
                     Reflections& reflections) const;
  Passing cross(SampleSet& set, const SurfaceHit& hit, std::uint64_t random, int lane, RayPacket& packet,
                Color& throughput) const;
  std::uint32_t reaching_sky(const SampleSet& set, int first, RayPacket& packet) const;
  bool reflects_at_coat(const SurfaceHit& hit, std::uint64_t random, int lane, RayPacket& packet, Color& throughput,
                        Color& passed) const;
  void trace_reflections(SampleSet& set, int first, RayPacket& packet, Reflections& reflections) const;

  static constexpr int kGuideReach = 64;  ///< Neighbours of a row are at most so many rows before or after it.
  static constexpr int kGuideSweeps = 3;  ///< In which rows learn from each other.
  static constexpr int kRowsForGuides = kGuideReach * (kGuideSweeps + 1);  ///< That a row's guide depends on.

  static void find_neighbours(std::span<SkyRow> rows, std::size_t at);
  static std::optional<SkyGuide> guide(std::span<const SkyRow> rows, std::size_t at, int sample_set);
  void guide_to_sky(std::span<RowBlock> blocks, const Tables& tables) const;
  void learn_sky(std::span<SkyRow> rows, std::int32_t first, int sweep) const;
  void add_guided(std::span<const SkyRow> rows, std::int32_t first, const Tables& tables, RowBlock& block) const;
  template <class Act>
  void cast_guided(SampleSet& set, const SkyGuide& guide, const DirectionTable& table, Act act) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const std::span<const Patch> receivers_;
  const Elements& elements_;
  std::uint64_t seed_;
  const bool visible_fractions_;
  const std::span<const std::uint8_t> ray_factors_;  ///< [receivers] Or empty.
  enum class Finish : std::uint8_t { diffuse, coated, specular, passable };
  std::vector<Finish> finish_;  ///< [primitives].
  bool has_specular_ = false;
};

}  // namespace patchlight

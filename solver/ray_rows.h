#pragma once
#include <span>

#include "pipeline/model/transport.h"
#include "pipeline/optics/elements.h"
#include "pipeline/optics/ray_scene.h"
#include "pipeline/stage/progress.h"
#include "solver/direction_table.h"
#include "solver/surroundings.h"

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
  enum class Halves { apart, together };

  /// Of `receivers`, patches of the scene's primitives or, of no size, points of them, to `elements`.
  /// Rays of receivers that start where `exposed` does not keep them are left out of the rows.
  RayRows(const PatchSet& scene, const RayScene& ray_scene, std::span<const Patch> receivers, const Elements& elements,
          std::uint64_t seed, const ExposedParts* exposed = nullptr, Halves halves = Halves::apart);

  /// Sets starts, ends and mirrored of `to`, with `rays` a row, rounded up to a multiple of 32, but for what is left
  /// out. The same for any number of threads. Returns how many rays were cast, those behind mirrors included. Throws:
  /// Error (interrupted).
  std::int64_t cast(int rays, TransportRows& to, Progress& progress) const;

 private:
  struct Half;

  void leave_out(const Half& half, const DirectionTable& table, int first, RayPacket& packet, std::int32_t* ends) const;
  void start_packet(const Half& half, const DirectionTable& table, int first, RayPacket& packet) const;
  void cast_half(const Half& half, const DirectionTable& table, std::int32_t* ends,
                 std::vector<TransportRows::Mirrored>& mirrored) const;
  void follow_mirrors(const Half& half, int first, int rays, RayPacket& packet,
                      std::vector<TransportRows::Mirrored>& mirrored) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const std::span<const Patch> receivers_;
  const Elements& elements_;
  std::uint64_t seed_;
  const ExposedParts* exposed_;
  const bool apart_;
  std::vector<char> metallic_;  ///< By primitive.
  bool has_metals_ = false;
};

}  // namespace patchlight

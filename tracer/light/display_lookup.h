#pragma once
#include "pipeline/model/energy_field.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "tracer/light/irradiance_lookup.h"

namespace patchlight {

/// Irradiance of the display solution, W/m2: on the patches that a DisplayMesh cuts, bilinear between the corners of
/// its leaves, on facets between vertices of their own, on others between patches.
///
/// Where something stands between a leaf's corners, those that a point does not see have no say.
class DisplayLookup {
 public:
  /// `patches` holds the same light under the same mixes.
  DisplayLookup(const PatchSet& scene, const RayScene& ray_scene, const IrradianceLookup& patches,
                const EnergyField& energy, const std::vector<LightMix>& mixes);

  /// Which corners of leaves the last few places saw, for places near them: those of a pixel.
  class Seen {
   public:
    /// The places that come are of another pixel.
    void start(std::uint32_t pixel);

   private:
    friend class DisplayLookup;
    static constexpr int kLeaves = 4;
    static constexpr int kUses = 16;  ///< Then it is looked at anew, so that many samples of a pixel have their mean.
    struct Entry {
      const DisplayMesh::Cell* leaf = nullptr;
      std::uint32_t corners = 0;
      int uses = 0;
    };

    std::uint32_t pixel_ = 0;
    std::array<Entry, kLeaves> entries_{};
    int next_ = 0;
  };

  /// The vertices that a place lies between, and what each counts for.
  struct Blend {
    std::array<std::int32_t, 4> vertices{-1, -1, -1, -1};  ///< The first is -1 on a patch that is whole.
    std::array<float, 4> weights{};
  };

  /// Of (u,v) of primitive `i`, which lies on patch `patch`.
  Blend blend(std::int32_t i, std::int32_t patch, float u, float v, Seen& seen) const;

  /// At (u,v) of primitive `i`, whose blend this is, under one of the mixes.
  Color operator()(const Blend& blend, std::int32_t i, float u, float v, std::size_t mix = 0) const;

 private:
  std::uint32_t corners_seen(const DisplayMesh::Cell& leaf, std::int32_t i, float u, float v, Seen& seen) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const IrradianceLookup& patches_;
  const DisplayMesh& mesh_;
  /// [mixes][vertices], and behind them what patches say at corners of facets.
  std::vector<std::vector<Color>> irradiance_;
  std::vector<std::int32_t> facet_of_;                 ///< [patches], into `facets_`; -1: none. Empty: no facets.
  std::vector<std::array<std::int32_t, 4>> facets_{};  ///< Their corners, in rows of growing u.
};

}  // namespace patchlight

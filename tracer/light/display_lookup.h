#pragma once
#include "pipeline/model/energy_field.h"
#include "pipeline/optics/intersect/ray_scene.h"
#include "tracer/light/irradiance_lookup.h"

namespace patchlight {

/// Irradiance of the display solution, W/m2: bilinear between the corners of a leaf on patches that the DisplayMesh
/// subdivides, between vertices on its facets, and by IrradianceLookup on all other patches.
///
/// In a leaf marked as cut, corners hidden from the point are left out.
class DisplayLookup {
 public:
  /// `patches` is the lookup of the same solution under the same mixes.
  DisplayLookup(const PatchSet& scene, const RayScene& ray_scene, const IrradianceLookup& patches,
                const EnergyField& energy, const std::vector<LightMix>& mixes);

  /// Visible corners of the leaves that a pixel's last few points lie in.
  class CornerCache {
   public:
    /// Clears the cache unless `pixel` is the one of the previous call.
    void start(std::uint32_t pixel);

   private:
    friend class DisplayLookup;
    static constexpr int kLeaves = 4;
    static constexpr int kMaxUses = 16;  ///< Then visibility is tested again, to average it over a pixel's samples.
    struct Entry {
      const DisplayMesh::Cell* leaf = nullptr;
      std::uint32_t corners = 0;
      int uses = 0;
    };

    std::uint32_t pixel_ = 0;
    std::array<Entry, kLeaves> entries_{};
    int next_ = 0;
  };

  /// The vertices around a point, and their weights.
  struct Blend {
    std::array<std::int32_t, 4> vertices{-1, -1, -1, -1};  ///< The first is -1 on a patch that is not subdivided.
    std::array<float, 4> weights{};
  };

  /// At (u,v) of primitive `i`, which lies on patch `patch`.
  Blend blend(std::int32_t i, std::int32_t patch, float u, float v, CornerCache& cache) const;

  /// Irradiance at (u,v) of primitive `i`, whose blend is given, under one of the mixes.
  Color operator()(const Blend& blend, std::int32_t i, float u, float v, std::size_t mix = 0) const;

 private:
  /// Corners visible from the point, as bits.
  std::uint32_t cached_visible_corners(const DisplayMesh::Cell& leaf, std::int32_t i, float u, float v,
                                       CornerCache& cache) const;

  const PatchSet& scene_;
  const RayScene& ray_scene_;
  const IrradianceLookup& patches_;
  const DisplayMesh& mesh_;
  /// [mixes][vertices + corners of facets without a vertex].
  std::vector<std::vector<Color>> irradiance_;
  std::vector<std::int32_t> facet_of_;                 ///< [patches], into `facets_`; -1: none. Empty: no facets.
  std::vector<std::array<std::int32_t, 4>> facets_{};  ///< Corners, into a mix of `irradiance_`, in rows of growing u.
};

}  // namespace patchlight

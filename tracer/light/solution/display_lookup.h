#pragma once
#include "pipeline/model/energy_field.h"
#include "pipeline/optics/transport/face_lookup.h"
#include "tracer/light/solution/irradiance_lookup.h"

namespace patchlight {

/// Irradiance of the display solution, W/m2, on patches that the DisplayMesh subdivides and on its facets; by
/// IrradianceLookup on all other patches. Bilinear between the corners of a leaf, with linear corrections towards the
/// middles of edges that border on such patches, and by mean value coordinates (Floater 2003) between the corners of a
/// part of a leaf; so it is continuous except where other surfaces stand on a leaf or cross it.
class DisplayLookup {
 public:
  /// `patches` is the lookup of the same solution under the same mixes.
  DisplayLookup(const PatchSet& scene, const IrradianceLookup& patches, const EnergyField& energy,
                const std::vector<LightMix>& mixes);

  /// The vertices around a point, and their weights.
  struct Blend {
    int count = 0;  ///< 0 on a patch that is not subdivided.
    std::array<std::int32_t, DisplayMesh::kMostCorners> vertices{};
    std::array<float, DisplayMesh::kMostCorners> weights{};
  };

  /// At (u,v) of primitive `i`, on the given patch.
  Blend blend(std::int32_t i, std::int32_t patch, float u, float v) const;

  /// Irradiance at (u,v) of primitive `i`, whose blend is given, under one of the mixes.
  Color operator()(const Blend& blend, std::int32_t i, float u, float v, std::size_t mix = 0) const;

 private:
  void place_corners(const PatchSet& scene);
  void set_mean_value_weights(std::int32_t face, float u, float v, Blend& blend) const;
  void add_middles(std::int32_t patch, const FaceLookup::Place& place, Blend& blend) const;

  const PatchSet& scene_;
  const IrradianceLookup& patches_;
  const DisplayMesh& mesh_;
  const FaceLookup faces_;
  /// [faces] Of a face that is a part of a leaf: index into `corner_places_` of its corners' positions; -1: none.
  /// Empty: no leaf is cut. Vertices lie a little beside the corners.
  std::vector<std::int32_t> first_place_;
  std::vector<Vec2f> corner_places_;  ///< In (u,v).
  /// [mixes][vertices + blends + corners of facets without either].
  std::vector<std::vector<Color>> irradiance_;
  std::vector<std::int32_t> facet_of_;                 ///< [primitives], into `facets_`; -1: none. Empty: no facets.
  std::vector<std::array<std::int32_t, 4>> facets_{};  ///< Corners, into a mix of `irradiance_`, in rows of growing u.
};

}  // namespace patchlight

#pragma once
#include "pipeline/model/patch_set.h"
#include "solver/form_factors/form_factors.h"
#include "solver/form_factors/visible_density.h"
#include "solver/hemicube/patch_id_renderer.h"

namespace patchlight {

/// One of the five views of a hemicube with `resolution` cells along an edge, and its rows in the hemicube's image of
/// `resolution` columns and 3 * `resolution` rows: first the top face, then the upper halves of the four sides, whose
/// rows start at the surface.
struct HemicubeFace {
  GlView view;
  int row;   ///< First row of the image.
  int rows;  ///< `resolution` for the top, half as many for a side.
};

/// Faces of the hemicube at a point of a surface, rotated by `angle` (rad) about the normal. `size`: edge length of the
/// patch, m; the near plane is at 1e-4 of it.
std::array<HemicubeFace, 5> hemicube_faces(const Vec3f& point, const Vec3f& normal, float angle, float size,
                                           int resolution);

/// Form factor of each cell of the image from the centre of the hemicube's base, normalised to a sum of 1.
/// Top: dA / (pi (x^2 + y^2 + 1)^2), sides: z dA / (pi (y^2 + z^2 + 1)^2), at the cells' centres.
/// Shape: [3 * resolution * resolution].
/// Source: Cohen and Greenberg 1985, with the 1 / pi and the square.
std::vector<float> hemicube_weights(int resolution);

/// Form factors by hemicubes, drawn with OpenGL: the first of a patch at its centre, further ones at other points of
/// it, each with a random rotation against aliasing. Weights of the cells are normalised, so that full rows sum to 1.
class HemicubeFormFactors : public FormFactorSource {
 public:
  /// `densities`: of further points over the patches; must outlive this object.
  /// Throws: Error (unavailable) without OpenGL; (bad_config) for an odd resolution.
  HemicubeFormFactors(const PatchSet& scene, int resolution, std::uint64_t seed,
                      const VisibleDensities& densities = kUniform);

  std::size_t batch(std::span<const Shot> shots) const override;
  std::vector<std::span<const FormFactor>> rows(std::span<const Shot> shots) override;

 private:
  inline static const VisibleDensities kUniform{};

  void draw(const Shot& shot, int bottom);
  std::size_t gather(const std::uint32_t* ids);

  const PatchSet& scene_;
  int resolution_;
  std::uint64_t seed_;
  const VisibleDensities& densities_;
  PatchIdRenderer renderer_;
  std::vector<float> prefix_sums_;          ///< Of the cells' weights in each row of the image.
  std::vector<int> run_ends_;               ///< Last cells of the runs of equal ids in a row of the image.
  std::vector<float> factor_of_id_;         ///< By id; zero between hemicubes.
  std::vector<std::uint32_t> visible_ids_;  ///< Ids of the current hemicube.
  std::vector<FormFactor> factors_;
};

}  // namespace patchlight

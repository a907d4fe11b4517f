#pragma once
#include "pipeline/model/patch_set.h"
#include "solver/form_factors/form_factors.h"
#include "solver/hemicube/patch_id_renderer.h"

namespace patchlight {

/// The five views of a hemicube of `resolution` cells along an edge, and where each stands in its image of `resolution`
/// columns and three times as many rows: the top face, then the upper halves of the four sides, rows growing away from
/// the surface.
struct HemicubeFace {
  GlView view;
  int row;   ///< First row of the image.
  int rows;  ///< `resolution` for the top, half of it for a side.
};

/// Faces of the hemicube about a point of a surface, turned by `angle` (rad) about the normal. `size`: edge length of
/// the patch, m; the near plane stands at 1e-4 of it.
std::array<HemicubeFace, 5> hemicube_faces(const Vec3f& point, const Vec3f& normal, float angle, float size,
                                           int resolution);

/// Form factor of each cell of that image as seen from the middle of the bottom; their sum is made exactly 1.
/// Top: dA / (pi (x^2 + y^2 + 1)^2), sides: z dA / (pi (y^2 + z^2 + 1)^2), at the cells' centres.
/// Shape: [3 * resolution * resolution].
/// Source: Cohen and Greenberg 1985, with the 1 / pi and the square.
std::vector<float> hemicube_weights(int resolution);

/// Form factors by hemicubes, drawn with OpenGL: the first of a patch about its centre, further ones about other points
/// of it, each turned at random against aliasing. A row is divided by the sum of all cells.
class HemicubeFormFactors : public FormFactorSource {
 public:
  /// Throws: Error (unavailable) without OpenGL; (bad_config) for an odd resolution.
  HemicubeFormFactors(const PatchSet& scene, int resolution, std::uint64_t seed);

  std::size_t batch(std::span<const Shot> shots) const override;
  std::vector<std::span<const FormFactor>> rows(std::span<const Shot> shots) override;

 private:
  void draw(const Shot& shot, int bottom);
  std::size_t gather(const std::uint32_t* ids);

  const PatchSet& scene_;
  int resolution_;
  std::uint64_t seed_;
  PatchIdRenderer renderer_;
  std::vector<float> sums_;             ///< Of a cell and those before it in its row of the image.
  std::vector<int> ends_;               ///< Last cells of the runs of equal ids in a row of the image.
  std::vector<float> row_;              ///< By id; zero between rows.
  std::vector<std::uint32_t> reached_;  ///< Ids of the row in the making.
  std::vector<FormFactor> factors_;
};

}  // namespace patchlight

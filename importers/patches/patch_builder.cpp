#include "importers/patches/patch_builder.h"

#include <fmt/format.h>

#include "pipeline/model/error.h"

namespace patchlight {

std::vector<Patch> build_patches(const std::vector<Primitive>& primitives,
                                 const std::vector<SurfaceMaterial>& materials,
                                 const std::vector<PatchTarget>& targets) {
  std::vector<Patch> patches;
  double cells = 0.0;  // of regions
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    if (primitives[i].region) {
      const QuadGrid grid = targets[i].grid.columns > 0 ? targets[i].grid : quad_grid(primitives[i], targets[i].area);
      cells += double(grid.columns) * grid.rows;
    }
    if (cells > double(Region::kMostCells))
      throw Error(ExitCode::over_limit,
                  fmt::format("grids on planar regions have more than {} cells", Region::kMostCells),
                  "import.patch_area", "raise it, or lower import.accuracy");
    append_patches(primitives[i], static_cast<std::int32_t>(i), materials[primitives[i].material], targets[i], patches);
  }
  return patches;
}

}  // namespace patchlight

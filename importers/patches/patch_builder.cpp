#include "importers/patches/patch_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "importers/patches/patch_grid.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr double kDefaultPatches = 8000.0;

/// Primitives to subdivide, with their materials.
struct Subdivision {
  const std::vector<Primitive>& primitives;
  const std::vector<SurfaceMaterial>& materials;

  double area_for(const Primitive& primitive, double scene_area) const {
    const double own = materials[static_cast<std::size_t>(primitive.material)].patch_area;
    return own > 0.0 ? own : scene_area;
  }

  double count(double scene_area) const {
    double sum = 0.0;
    for (const Primitive& primitive : primitives) sum += patch_count(primitive, area_for(primitive, scene_area));
    return sum;
  }
};

/// Rounds up to two significant digits, so that a message can suggest the number.
double rounded_up(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::ceil(value / unit) * unit;
}

/// Approximately the smallest patch area that gives at most `limit` patches.
double fitting_patch_area(const Subdivision& subdivision, double limit, double area) {
  double fits = area / limit;
  while (subdivision.count(fits) > limit) fits *= 2.0;
  double fails = fits * 0.5;
  for (int i = 0; i < 12; ++i) {
    const double middle = std::sqrt(fits * fails);
    (subdivision.count(middle) > limit ? fails : fits) = middle;
  }
  // Counts do not decrease monotonically with the area: columns and rows are rounded.
  for (double candidate = rounded_up(fits);; candidate = rounded_up(candidate * 1.05)) {
    if (subdivision.count(candidate) <= limit) return candidate;
  }
}

}  // namespace

double choose_patch_area(const std::vector<Primitive>& primitives, const std::vector<SurfaceMaterial>& materials,
                         const ImportConfig& config) {
  const Subdivision subdivision{primitives, materials};
  double area = 0.0;
  for (const Primitive& primitive : primitives) area += primitive_area(primitive);
  const double wanted = config.patch_area.value_or(area / kDefaultPatches);
  const auto limit = static_cast<double>(config.max_patches);
  const double count = subdivision.count(wanted);
  if (count <= limit) return wanted;

  const double least = subdivision.count(std::numeric_limits<double>::infinity());
  if (least > limit) {
    throw Error(ExitCode::over_limit,
                fmt::format("the scene needs {:.0f} patches, one for each surface or as many as its own patch_area "
                            "asks for, and import.max_patches is {:.0f}",
                            least, limit),
                "import.max_patches", "raise it, raise the patch_area of materials and nodes, or simplify the scene");
  }
  const double fitting = fitting_patch_area(subdivision, limit, area);
  if (!config.patch_area) return fitting;
  throw Error(ExitCode::over_limit,
              fmt::format("{:.4g} patches are more than import.max_patches, {:.0f}", count, limit),
              fmt::format("import.patch_area {:g}", wanted),
              fmt::format("a patch_area of {:.3g} fits, or raise import.max_patches", fitting));
}

std::vector<Patch> build_patches(const std::vector<Primitive>& primitives,
                                 const std::vector<SurfaceMaterial>& materials, double patch_area) {
  const Subdivision subdivision{primitives, materials};
  std::vector<Patch> patches;
  patches.reserve(static_cast<std::size_t>(subdivision.count(patch_area)));
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    append_patches(primitives[i], static_cast<std::int32_t>(i), materials[primitives[i].material],
                   subdivision.area_for(primitives[i], patch_area), patches);
  }
  return patches;
}

}  // namespace patchlight

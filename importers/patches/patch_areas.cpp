#include "importers/patches/patch_areas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "importers/patches/facet_bodies.h"
#include "importers/patches/patch_grid.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr double kScale = 16.0;  // ratio of extents within one scale
constexpr double kLone = 0.125;  // part of the patches of a surface that is alone in its scale
constexpr double kBox = 6.0;     // facets of a body that count one by one

/// The longest distance on a primitive, m.
double extent_of(const Primitive& p) {
  if (p.shape == Primitive::Shape::sphere) return 2.0 * std::abs(p.sphere_radius);
  return std::max((p.corners[2] - p.corners[0]).length(), (p.corners[3] - p.corners[1]).length());
}

/// The extent by which each primitive belongs to a scale, m: that of its body for a facet of many, however small it is.
std::vector<double> extents_of(const std::vector<Primitive>& primitives) {
  const FacetBodies bodies(primitives);
  std::vector<double> extents;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const double own = extent_of(primitives[i]);
    const std::int32_t body = bodies.body(std::int32_t(i));
    extents.push_back(std::max(own, std::min(bodies.extent(body), own * std::sqrt(bodies.size(body) / kBox))));
  }
  return extents;
}

/// Areas of patches that are in proportion to a common factor.
class Areas {
 public:
  Areas(const std::vector<Primitive>& primitives, const std::vector<SurfaceMaterial>& materials,
        std::vector<double> proportions)
      : primitives_(primitives), materials_(materials), proportions_(std::move(proportions)) {}

  double area(std::size_t i, double factor) const {
    const double own = materials_[primitives_[i].material].patch_area;
    return own > 0.0 ? own : factor * proportions_[i];
  }

  double count(double factor) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < primitives_.size(); ++i) sum += patch_count(primitives_[i], area(i, factor));
    return sum;
  }

  std::vector<double> all(double factor) const {
    std::vector<double> areas(primitives_.size());
    for (std::size_t i = 0; i < areas.size(); ++i) areas[i] = area(i, factor);
    return areas;
  }

 private:
  const std::vector<Primitive>& primitives_;
  const std::vector<SurfaceMaterial>& materials_;
  std::vector<double> proportions_;
};

/// Rounds up to two significant digits, so that a message can suggest the number.
double rounded_up(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::ceil(value / unit) * unit;
}

/// Approximately the smallest factor from `fails` on that gives at most `limit` patches.
double fitting_factor(const Areas& areas, double limit, double fails) {
  double fits = fails;
  while (areas.count(fits) > limit) fits *= 2.0;
  fails = fits * 0.5;
  for (int i = 0; i < 12; ++i) {
    const double middle = std::sqrt(fits * fails);
    (areas.count(middle) > limit ? fails : fits) = middle;
  }
  // Counts do not decrease monotonically with the area: columns and rows are rounded.
  for (double candidate = rounded_up(fits);; candidate = rounded_up(candidate * 1.05)) {
    if (areas.count(candidate) <= limit) return candidate;
  }
}

}  // namespace

std::vector<double> areas_of_scale(const std::vector<Primitive>& primitives) {
  const std::size_t n = primitives.size();
  const std::vector<double> extents = extents_of(primitives);
  std::vector<double> result(n);
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return extents[a] < extents[b]; });
  std::vector<double> smaller(n + 1, 0.0);  // area of those before k
  std::vector<double> larger(n + 1, 0.0);   // area over extent^4 of those from k on
  for (std::size_t k = 0; k < n; ++k) smaller[k + 1] = smaller[k] + primitive_area(primitives[order[k]]);
  for (std::size_t k = n; k-- > 0;)
    larger[k] = larger[k + 1] + primitive_area(primitives[order[k]]) / std::pow(extents[order[k]], 4);
  std::size_t beyond = 0;  // the first that is larger than the scale
  for (const std::size_t i : order) {
    const double scale = kScale * extents[i];
    while (beyond < n && extents[order[beyond]] <= scale) ++beyond;
    const double area = smaller[beyond] + larger[beyond] * std::pow(scale, 4);
    const bool is_flat = primitives[i].shape == Primitive::Shape::quad;
    const double own = is_flat ? primitive_area(primitives[i]) * (primitives[i].back >= 0 ? 2.0 : 1.0) : 0.0;
    const double lone = std::max(0.0, 2.0 * own / area - 1.0);
    result[i] = area / std::max(kLone, 1.0 - lone * lone);
  }
  return result;
}

std::vector<double> choose_patch_areas(const std::vector<Primitive>& primitives,
                                       const std::vector<SurfaceMaterial>& materials, const ImportConfig& config) {
  const bool is_given = config.patch_area.has_value();
  const Areas areas(primitives, materials,
                    is_given ? std::vector<double>(primitives.size(), 1.0) : areas_of_scale(primitives));
  const double wanted = is_given ? *config.patch_area : 1.0 / (kDefaultPatches * config.accuracy);
  const auto limit = static_cast<double>(config.max_patches);
  const double count = areas.count(wanted);
  if (count <= limit) return areas.all(wanted);

  const double least = areas.count(std::numeric_limits<double>::infinity());
  if (least > limit) {
    throw Error(ExitCode::over_limit,
                fmt::format("the scene needs {:.0f} patches, one for each surface or as many as its own patch_area "
                            "asks for, and import.max_patches is {:.0f}",
                            least, limit),
                "import.max_patches", "raise it, raise the patch_area of materials and nodes, or simplify the scene");
  }
  const double fitting = fitting_factor(areas, limit, wanted);
  if (!is_given) return areas.all(fitting);
  throw Error(ExitCode::over_limit,
              fmt::format("{:.4g} patches are more than import.max_patches, {:.0f}", count, limit),
              fmt::format("import.patch_area {:g}", wanted),
              fmt::format("a patch_area of {:.3g} fits, or raise import.max_patches", fitting));
}

}  // namespace patchlight

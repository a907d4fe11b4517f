#include "solver/display/fine_detail.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/model/cuts/cut_cells.h"

namespace patchlight {

namespace {

constexpr double kPart = 1.0 / 24;         // of a crossing's extent
constexpr double kOfDistance = 0.5;        // size of a cell over its distance from a crossing
constexpr double kCellsBesideAPart = 6.0;  // an estimate: cells for each that lies beside a crossing
constexpr double kStep = 1.1;              // of the search for the smallest cells
constexpr double kMostCells = 0.25;        // over the number of patches

Imath::Box2d box_of(const Crossing& crossing) {
  Imath::Box2d box(crossing.from);
  box.extendBy(crossing.to);
  return box;
}

/// Distance between two boxes.
double distance(const Imath::Box2d& a, const Imath::Box2d& b) {
  const double x = std::max({0.0, a.min.x - b.max.x, b.min.x - a.max.x});
  const double y = std::max({0.0, a.min.y - b.max.y, b.min.y - a.max.y});
  return std::hypot(x, y);
}

}  // namespace

FineDetail::FineDetail(const PatchSet& scene, const std::vector<std::vector<Crossing>>& crossings)
    : scene_(scene), crossings_(crossings) {
  const double most = kMostCells * double(scene.patches.size());
  const auto cells = [&](double smallest) {
    double count = 0;
    for (const auto& of_primitive : crossings)
      for (const Crossing& crossing : of_primitive)
        count +=
            kCellsBesideAPart * (crossing.to - crossing.from).length() / std::max(kPart * crossing.extent, smallest);
    return count;
  };
  double least = std::numeric_limits<double>::infinity();
  for (const auto& of_primitive : crossings)
    for (const Crossing& crossing : of_primitive) least = std::min(least, kPart * crossing.extent);
  if (least > 0 && std::isfinite(least) && cells(0) > most)
    for (smallest_ = least; cells(smallest_) > most;) smallest_ *= kStep;
}

bool FineDetail::is_too_large(const Patch& cell) const {
  const auto& crossings = crossings_[cell.primitive];
  if (crossings.empty()) return false;
  const Primitive& primitive = scene_.primitives[cell.primitive];
  const PlaneFrame frame = *PlaneFrame::of(primitive);
  Imath::Box2d box;
  for (const Vec2d& corner : cell_polygon(primitive, frame, cell)) box.extendBy(corner);
  const double size = std::sqrt(cell.area);
  return std::any_of(crossings.begin(), crossings.end(), [&](const Crossing& crossing) {
    return crossing.height <= size && size > std::max(kPart * crossing.extent, smallest_) &&
           size > kOfDistance * distance(box, box_of(crossing));
  });
}

}  // namespace patchlight

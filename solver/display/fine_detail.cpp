#include "solver/display/fine_detail.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/model/cuts/cut_cells.h"

namespace patchlight {

namespace {

constexpr double kPart = 1.0 / 12;         // of a crossing's extent
constexpr double kFinePart = 1.0 / 64;     // of the extent, beside what is low
constexpr double kOfRelief = 0.5;          // of what stands there
constexpr double kOfDistance = 0.5;        // size of a cell over its distance from a crossing
constexpr double kCellsBesideAPart = 6.0;  // an estimate: cells for each that lies beside a crossing
constexpr double kUsual = 0.25;            // size of cells at creases over that of their patch, without this class
constexpr double kStep = 1.1;              // of the search for the smallest cells
constexpr double kMostCells = 2.0;         // over the number of patches

Imath::Box2d box_of(const Crossing& crossing) {
  Imath::Box2d box(crossing.from);
  box.extendBy(crossing.to);
  return box;
}

/// The largest size of cells beside a crossing, m.
double allowed_size(const Crossing& crossing) {
  return std::clamp(kOfRelief * crossing.relief, kFinePart * crossing.extent, kPart * crossing.extent);
}

/// Distance between two boxes.
double distance(const Imath::Box2d& a, const Imath::Box2d& b) {
  const double x = std::max({0.0, a.min.x - b.max.x, b.min.x - a.max.x});
  const double y = std::max({0.0, a.min.y - b.max.y, b.min.y - a.max.y});
  return std::hypot(x, y);
}

}  // namespace

FineDetail::FineDetail(const PatchSet& scene, std::vector<std::vector<Crossing>> crossings,
                       const std::vector<std::vector<Crossing>>& at_edges)
    : scene_(scene), crossings_(std::move(crossings)) {
  std::vector<double> usual(scene.primitives.size());
  for (const Patch& patch : scene.patches)
    usual[patch.primitive] = std::max(usual[patch.primitive], kUsual * std::sqrt(patch.area));
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < crossings_.size(); ++i) {
    std::copy_if(at_edges[i].begin(), at_edges[i].end(), std::back_inserter(crossings_[i]),
                 [&](const Crossing& crossing) { return allowed_size(crossing) < usual[i]; });
    for (const Crossing& crossing : crossings_[i]) least = std::min(least, allowed_size(crossing));
  }
  const double most = kMostCells * double(scene.patches.size());
  const auto cells = [&](double smallest) {
    double count = 0;
    for (std::size_t i = 0; i < crossings_.size(); ++i)
      for (const Crossing& crossing : crossings_[i])
        if (const double size = std::max(allowed_size(crossing), smallest); size < usual[i])
          count += kCellsBesideAPart * (crossing.to - crossing.from).length() / size;
    return count;
  };
  for (smallest_ = 0; cells(smallest_) > most;) smallest_ = std::max(least, kStep * smallest_);
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
    return crossing.height <= size && size > std::max(allowed_size(crossing), smallest_) &&
           size > kOfDistance * distance(box, box_of(crossing));
  });
}

}  // namespace patchlight

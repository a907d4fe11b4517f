#include "pipeline/optics/intersect/surface_sizes.h"

#include <vector>

namespace patchlight {

namespace {

constexpr std::size_t kMostForPackets = 1 << 19;
constexpr double kFinestForPackets = 1.0 / 8;

double area_of(const std::array<Vec3d, 4>& corners) {
  return 0.5 * ((corners[2] - corners[0]) % (corners[3] - corners[1])).length();
}

}  // namespace

SurfaceSizes::SurfaceSizes(const PatchSet& scene) {
  std::vector<double> areas;
  for (const Primitive& p : scene.primitives) {
    if (p.mask >= 0 || (p.back >= 0 && &p > &scene.primitives[p.back])) continue;
    if (p.region) {
      for (const auto& uv : p.region->pieces) {
        std::array<Vec3d, 4> corners;
        for (int k = 0; k < 4; ++k) corners[k] = position_at(p.corners, uv[k].x, uv[k].y);
        areas.push_back(area_of(corners));
      }
    } else if (p.shape == Primitive::Shape::sphere) {
      areas.push_back(4 * kPi * p.sphere_radius * p.sphere_radius);
    } else {
      areas.push_back(area_of(p.corners));
    }
  }
  count = areas.size();
  double sum = 0, fine_sum = 0;
  for (const double area : areas) sum += area;
  for (const double area : areas) fine_sum += area * double(kFew) < sum ? area : 0;
  if (sum > 0) fine = fine_sum / sum;
}

bool SurfaceSizes::suit_packets() const {
  return count <= kFew || (count <= kMostForPackets && fine <= kFinestForPackets);
}

}  // namespace patchlight

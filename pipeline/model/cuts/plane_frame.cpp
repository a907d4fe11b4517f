#include "pipeline/model/cuts/plane_frame.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

std::optional<PlaneFrame> PlaneFrame::of(const Primitive& primitive) {
  constexpr double kPlane = 1e-5;  // distance of a corner from the plane, relative to the size
  if (primitive.shape != Primitive::Shape::quad) return {};
  const auto& c = primitive.corners;
  const Vec3d diagonal = c[2] - c[0], other = c[3] - c[1];
  PlaneFrame frame;
  frame.origin_ = c[0];
  frame.normal_ = (diagonal % other).normalized();
  const double size = std::max(diagonal.length(), other.length());
  if (std::abs(frame.height(c[1])) > kPlane * size || std::abs(frame.height(c[3])) > kPlane * size) return {};
  frame.along_ = (c[1] - c[0] - frame.normal_ * frame.height(c[1])).normalized();
  frame.across_ = frame.normal_ % frame.along_;
  return frame;
}

}  // namespace patchlight

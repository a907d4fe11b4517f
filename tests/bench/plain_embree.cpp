#include "tests/bench/plain_embree.h"

#include <limits>

#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

namespace {

template <class Packet, int kWidth>
std::int64_t trace(RTCScene scene, const std::vector<EmbreeRay>& rays,
                   void (*intersect)(const int*, RTCScene, RTCIntersectContext*, Packet*)) {
  alignas(64) std::array<int, kWidth> valid;
  valid.fill(-1);
  std::int64_t hits = 0;
  for (std::size_t first = 0; first < rays.size(); first += kWidth) {
    alignas(64) Packet packet;
    for (int lane = 0; lane < kWidth; ++lane) {
      const EmbreeRay& ray = rays[first + lane];
      packet.ray.org_x[lane] = ray.origin.x;
      packet.ray.org_y[lane] = ray.origin.y;
      packet.ray.org_z[lane] = ray.origin.z;
      packet.ray.dir_x[lane] = ray.direction.x;
      packet.ray.dir_y[lane] = ray.direction.y;
      packet.ray.dir_z[lane] = ray.direction.z;
      packet.ray.tnear[lane] = packet.ray.time[lane] = 0;
      packet.ray.tfar[lane] = std::numeric_limits<float>::infinity();
      packet.ray.mask[lane] = ~0u;
      packet.ray.id[lane] = packet.ray.flags[lane] = 0;
      packet.hit.geomID[lane] = packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    intersect(valid.data(), scene, &context, &packet);
    for (int lane = 0; lane < kWidth; ++lane) hits += packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
  }
  return hits;
}

}  // namespace

std::vector<Triangle> triangles_of(const PatchSet& scene, const RayScene& rays) {
  std::vector<Triangle> triangles;
  for (const Primitive& primitive : scene.primitives) {
    const bool sphere = primitive.shape == Primitive::Shape::sphere;
    const int columns = sphere ? 64 : 1, rows = sphere ? 32 : 1;
    const auto corner = [&](int i, int j) {
      return rays.to_local(point_at(primitive, float(i) / float(columns), float(j) / float(rows)).position);
    };
    for (int i = 0; i < columns; ++i)
      for (int j = 0; j < rows; ++j) {
        triangles.push_back({corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)});
        if (!primitive.is_triangle()) triangles.push_back({corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)});
      }
  }
  return triangles;
}

PlainEmbree::PlainEmbree(const std::vector<Triangle>& triangles) : device_(rtcNewDevice(nullptr)) {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               sizeof(Vec3f), 3 * triangles.size()));
  auto* indices = static_cast<std::array<unsigned, 3>*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles.size()));
  for (unsigned t = 0; t < triangles.size(); ++t) {
    for (unsigned k = 0; k < 3; ++k) vertices[3 * t + k] = triangles[t][k];
    indices[t] = {3 * t, 3 * t + 1, 3 * t + 2};
  }
  rtcCommitGeometry(geometry);
  scene_ = rtcNewScene(device_);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
}

PlainEmbree::~PlainEmbree() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

std::int64_t PlainEmbree::count_hits(const std::vector<EmbreeRay>& rays, int width) const {
  return width == 16 ? trace<RTCRayHit16, 16>(scene_, rays, rtcIntersect16)
                     : trace<RTCRayHit8, 8>(scene_, rays, rtcIntersect8);
}

}  // namespace patchlight

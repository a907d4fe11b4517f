#include "tests/bench/plain_embree.h"

#include <array>
#include <limits>

#include "pipeline/optics/sampling/patch_sampling.h"

namespace patchlight {

namespace {

using Quad = std::array<Vec3f, 4>;

template <class Packet, int kWidth>
std::int64_t trace(RTCScene scene, const std::vector<EmbreeRay>& rays, bool coherent,
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
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    intersect(valid.data(), scene, &context, &packet);
    for (int lane = 0; lane < kWidth; ++lane) hits += packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
  }
  return hits;
}

std::vector<Quad> quads_of(const PatchSet& scene, const RayScene& rays) {
  std::vector<Quad> quads;
  for (const Primitive& p : scene.primitives) {
    if (p.back >= 0 && &p > &scene.primitives[p.back]) continue;  // the other side of a surface
    const auto add = [&](double u0, double v0, double u1, double v1) {
      const auto at = [&](double u, double v) { return rays.to_local(point_at(p, u, v).position); };
      quads.push_back({at(u0, v0), at(u1, v0), at(u1, v1), at(u0, v1)});
    };
    if (p.region) {
      for (const auto& uv : p.region->pieces) {
        Quad& quad = quads.emplace_back();
        for (int k = 0; k < 4; ++k) quad[k] = rays.to_local(position_at(p.corners, uv[k].x, uv[k].y));
      }
    } else if (p.shape == Primitive::Shape::sphere) {
      constexpr int kColumns = 64, kRows = 32;
      for (int i = 0; i < kColumns; ++i)
        for (int j = 0; j < kRows; ++j)
          add(double(i) / kColumns, double(j) / kRows, double(i + 1) / kColumns, double(j + 1) / kRows);
    } else {
      quads.push_back(rays.to_local(p.corners));
    }
  }
  return quads;
}

}  // namespace

PlainEmbree::PlainEmbree(const PatchSet& scene, const RayScene& rays, Variant variant)
    : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
  const bool as_quads = variant == Variant::quads;
  const std::vector<Quad> quads = quads_of(scene, rays);
  std::vector<unsigned> corners;  // of triangles or quads
  for (unsigned q = 0; q < 4 * quads.size(); q += 4) {
    if (as_quads)
      corners.insert(corners.end(), {q, q + 1, q + 2, q + 3});
    else
      corners.insert(corners.end(), {q, q + 1, q + 3});
    if (!as_quads && quads[q / 4][2] != quads[q / 4][3]) corners.insert(corners.end(), {q + 2, q + 3, q + 1});
  }
  const unsigned each = as_quads ? 4 : 3;
  RTCGeometry geometry = rtcNewGeometry(device_, as_quads ? RTC_GEOMETRY_TYPE_QUAD : RTC_GEOMETRY_TYPE_TRIANGLE);
  void* const vertices =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), 4 * quads.size());
  std::copy(quads.begin(), quads.end(), static_cast<Quad*>(vertices));
  void* const indices =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, as_quads ? RTC_FORMAT_UINT4 : RTC_FORMAT_UINT3,
                              each * sizeof(unsigned), corners.size() / each);
  std::copy(corners.begin(), corners.end(), static_cast<unsigned*>(indices));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  if (variant == Variant::robust) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  if (variant == Variant::compact) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_COMPACT);
  if (variant == Variant::high_quality) rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  rtcCommitScene(scene_);
}

PlainEmbree::~PlainEmbree() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

std::int64_t PlainEmbree::count_hits(const std::vector<EmbreeRay>& rays, int width, bool coherent) const {
  return width == 16 ? trace<RTCRayHit16, 16>(scene_, rays, coherent, rtcIntersect16)
                     : trace<RTCRayHit8, 8>(scene_, rays, coherent, rtcIntersect8);
}

}  // namespace patchlight

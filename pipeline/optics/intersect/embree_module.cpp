#include "pipeline/optics/intersect/embree_module.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <limits>
#include <new>
#include <utility>

namespace patchlight {

namespace {

class Tracer : public EmbreeTracer {
 public:
  explicit Tracer(RTCDevice device) : device_(device), scene_(rtcNewScene(device)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  }

  ~Tracer() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  void add_quads(const std::vector<std::array<Vec3f, 4>>& corners) override { attach(new_quads(corners), kQuads); }

  void add_filtered_quads(const std::vector<std::array<Vec3f, 4>>& corners, unsigned first, HitFilter filter) override {
    first_filtered_ = first;
    filter_ = std::move(filter);
    RTCGeometry geometry = new_quads(corners);
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryIntersectFilterFunction(geometry, reject_hits);
    rtcSetGeometryOccludedFilterFunction(geometry, reject_hits);
    attach(geometry, kQuads);
  }

  void add_spheres(const std::vector<std::array<float, 4>>& spheres) override {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    auto* vertices = static_cast<std::array<float, 4>*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), spheres.size()));
    if (!vertices) throw std::bad_alloc();
    std::copy(spheres.begin(), spheres.end(), vertices);
    attach(geometry, kSpheres);
  }

  /// Builds with one thread, so that the BVH, and with it the order of coincident hits, is deterministic. (The device
  /// option `threads=1` would limit TBB in the whole program while the device exists.)
  void build() override {
    tbb::task_arena(1).execute([&] { rtcCommitScene(scene_); });
    if (rtcGetDeviceError(device_) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  }

  void intersect(const std::array<int, 16>& valid, RTCRayHit16& rays, bool coherent) const override {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (int lane = 0; lane < 16; ++lane)
      if (valid[lane] == 0) disable_lane(rays.ray, lane);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(valid.data(), scene_, &context, &rays);
  }

  std::uint32_t occluded(RTCRay16& rays, std::uint32_t active) const override {
    alignas(64) std::array<int, 16> valid;
    for (int lane = 0; lane < 16; ++lane) {
      valid[lane] = -int(active >> lane & 1u);
      if (valid[lane] == 0) disable_lane(rays, lane);
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid.data(), scene_, &context, &rays);
    std::uint32_t occluded_lanes = 0;
    for (int lane = 0; lane < 16; ++lane)
      occluded_lanes |= std::uint32_t(valid[lane] != 0 && rays.tfar[lane] < 0) << lane;
    return occluded_lanes;
  }

 private:
  /// With registers of fewer than sixteen lanes, Embree ignores `valid` but tests tnear and tfar.
  static void disable_lane(RTCRay16& rays, int lane) {
    rays.tnear[lane] = std::numeric_limits<float>::infinity();
    rays.tfar[lane] = -std::numeric_limits<float>::infinity();
  }

  RTCGeometry new_quads(const std::vector<std::array<Vec3f, 4>>& corners) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_QUAD);
    auto* vertices = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 sizeof(Vec3f), 4 * corners.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4,
                                                                   4 * sizeof(unsigned), corners.size()));
    if (!vertices || !indices) throw std::bad_alloc();
    for (std::size_t i = 0; i < corners.size(); ++i)
      for (std::size_t k = 0; k < 4; ++k) {
        vertices[4 * i + k] = corners[i][k];
        indices[4 * i + k] = unsigned(4 * i + k);
      }
    return geometry;
  }

  void attach(RTCGeometry geometry, unsigned geometry_id) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_, geometry, geometry_id);
    rtcReleaseGeometry(geometry);
  }

  /// Adds first_filtered_ to primID, and rejects the hits that the filter does not accept.
  static void reject_hits(const RTCFilterFunctionNArguments* arguments) {
    const auto& tracer = *static_cast<const Tracer*>(arguments->geometryUserPtr);
    RTCRayN* const rays = arguments->ray;
    RTCHitN* const hits = arguments->hit;
    const unsigned count = arguments->N;
    for (unsigned k = 0; k < count; ++k) {
      if (arguments->valid[k] == 0) continue;
      unsigned& quad = RTCHitN_primID(hits, count, k);
      quad += tracer.first_filtered_;
      const Vec3f origin(RTCRayN_org_x(rays, count, k), RTCRayN_org_y(rays, count, k), RTCRayN_org_z(rays, count, k));
      const Vec3f direction(RTCRayN_dir_x(rays, count, k), RTCRayN_dir_y(rays, count, k),
                            RTCRayN_dir_z(rays, count, k));
      const Vec2f at(RTCHitN_u(hits, count, k), RTCHitN_v(hits, count, k));
      if (!tracer.filter_(quad, at, origin, direction, RTCRayN_tfar(rays, count, k))) arguments->valid[k] = 0;
    }
  }

  RTCDevice device_;
  RTCScene scene_;
  unsigned first_filtered_ = 0;  ///< primID of the first filtered quad.
  HitFilter filter_;
};

}  // namespace

}  // namespace patchlight

patchlight::EmbreeTracer* make_embree_tracer() {
  RTCDevice device = rtcNewDevice("set_affinity=0");
  return device ? new patchlight::Tracer(device) : nullptr;
}

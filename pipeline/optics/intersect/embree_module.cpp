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

  void add_filtered_quads(const std::vector<std::array<Vec3f, 4>>& corners, unsigned first, Filter filter) override {
    first_ = first;
    filter_ = std::move(filter);
    RTCGeometry geometry = new_quads(corners);
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryIntersectFilterFunction(geometry, filter_hits);
    rtcSetGeometryOccludedFilterFunction(geometry, filter_hits);
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

  /// By one thread, so that the tree, and with it who wins between touching surfaces, is always the same. (Saying so to
  /// the device would bind the whole program to one, as long as the device lives.)
  void build() override {
    tbb::task_arena(1).execute([&] { rtcCommitScene(scene_); });
    if (rtcGetDeviceError(device_) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  }

  void intersect(const std::array<int, 16>& valid, RTCRayHit16& rays, bool coherent) const override {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (int lane = 0; lane < 16; ++lane)
      if (valid[lane] == 0) leave_out(rays.ray, lane);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(valid.data(), scene_, &context, &rays);
  }

  std::uint32_t occluded(RTCRay16& rays, std::uint32_t wanted) const override {
    alignas(64) std::array<int, 16> valid;
    for (int lane = 0; lane < 16; ++lane) {
      valid[lane] = -int(wanted >> lane & 1u);
      if (valid[lane] == 0) leave_out(rays, lane);
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid.data(), scene_, &context, &rays);
    std::uint32_t blocked = 0;
    for (int lane = 0; lane < 16; ++lane) blocked |= std::uint32_t(valid[lane] != 0 && rays.tfar[lane] < 0) << lane;
    return blocked;
  }

 private:
  /// Where registers hold less than sixteen lanes Embree does not look at `valid`, but at a ray's ends.
  static void leave_out(RTCRay16& rays, int lane) {
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

  void attach(RTCGeometry geometry, unsigned number) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_, geometry, number);
    rtcReleaseGeometry(geometry);
  }

  /// Numbers what rays come to, and takes back what they do not meet.
  static void filter_hits(const RTCFilterFunctionNArguments* arguments) {
    const auto& self = *static_cast<const Tracer*>(arguments->geometryUserPtr);
    RTCRayN* const rays = arguments->ray;
    RTCHitN* const hits = arguments->hit;
    const unsigned count = arguments->N;
    for (unsigned k = 0; k < count; ++k) {
      if (arguments->valid[k] == 0) continue;
      unsigned& quad = RTCHitN_primID(hits, count, k);
      quad += self.first_;
      const Vec3f origin(RTCRayN_org_x(rays, count, k), RTCRayN_org_y(rays, count, k), RTCRayN_org_z(rays, count, k));
      const Vec3f direction(RTCRayN_dir_x(rays, count, k), RTCRayN_dir_y(rays, count, k),
                            RTCRayN_dir_z(rays, count, k));
      const Vec2f at(RTCHitN_u(hits, count, k), RTCHitN_v(hits, count, k));
      if (!self.filter_(quad, at, origin, direction, RTCRayN_tfar(rays, count, k))) arguments->valid[k] = 0;
    }
  }

  RTCDevice device_;
  RTCScene scene_;
  unsigned first_ = 0;  ///< Of filtered quads.
  Filter filter_;
};

}  // namespace

}  // namespace patchlight

patchlight::EmbreeTracer* make_embree_tracer() {
  RTCDevice device = rtcNewDevice("set_affinity=0");
  return device ? new patchlight::Tracer(device) : nullptr;
}

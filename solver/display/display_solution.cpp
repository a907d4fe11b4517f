#include "solver/display/display_solution.h"

#include <ImathBox.h>

#include <algorithm>
#include <cmath>

#include "pipeline/optics/sampling/random.h"
#include "pipeline/optics/surface/smooth_normals.h"
#include "pipeline/optics/transport/elements.h"
#include "solver/direct/direct_factors.h"
#include "solver/direct/light_samples.h"
#include "solver/display/display_gather.h"
#include "solver/display/display_mesh_builder.h"
#include "solver/error/discretisation.h"
#include "solver/form_factors/ray_rows.h"
#include "solver/progress/solve_parts.h"

namespace patchlight {

namespace {

constexpr int kPatchRaysPerVertexRay = 2;  // vertices are dense where irradiance varies
constexpr int kMinVertexRays = 128;        // with fewer rays vertices show as blotches
// Squared sizes of faces over the target of patches, and factors of rays under an environment.
constexpr double kSmallFace = 1.0 / 256, kMediumFace = 1.0 / 64, kLargeFace = 1.0 / 16;
constexpr std::uint8_t kMediumFaceFactor = 2, kLargeFaceFactor = 4;
constexpr int kVertexRaysPerShadowRay = 8;  // rays of a vertex over the sample budget of an element's direct light

std::uint64_t display_seed(const SolveConfig& config) {
  return hash64(std::uint64_t(config.seed));
}

/// The gathering vertices as patches of no size, with the smooth normals of curved meshes.
std::vector<Patch> receivers(const PatchSet& scene, const DisplayMesh& mesh) {
  const SmoothNormals normals(scene);
  std::vector<Patch> points = vertex_patches(scene, mesh);
  for (Patch& point : points) point.normal = normals(point.primitive, point.u0, point.v0, point.normal);
  return points;
}

/// Squared length of the diagonal of some points' box in (u,v), over the squared side of a square of the given area.
/// The noise of slivers shows along their length.
class FaceSize {
 public:
  explicit FaceSize(const Primitive& primitive)
      : along_((primitive.corners[1] - primitive.corners[0]).length() + 2 * kPi * std::abs(primitive.sphere_radius)),
        across_((primitive.corners[3] - primitive.corners[0]).length() + kPi * std::abs(primitive.sphere_radius)) {}

  void add(float u, float v) { box_.extendBy(Vec2f(u, v)); }

  double over(double area) const {
    const Vec2f size = box_.size();
    const double u = along_ * double(size.x), v = across_ * double(size.y);
    return (u * u + v * v) / (2 * area);
  }

 private:
  double along_, across_;
  Imath::Box2f box_;
};

/// Factors of the rays of gathering vertices, by the largest face around each: where faces are large there are few
/// vertices, and their noise covers most of a frame; on patches that are small for their scale, it hardly shows.
std::vector<std::uint8_t> ray_factors(const PatchSet& scene, const DisplayMesh& mesh) {
  std::vector<std::pair<double, double>> areas;
  for (const Patch& patch : scene.patches) areas.emplace_back(patch.area, patch.area);
  const double median = weighted_percentile(std::move(areas), 0.5);
  std::vector<double> largest(std::size_t(mesh.gathered));
  const auto target = [&](const Primitive& p) { return p.patch_area > 0 ? p.patch_area : median; };
  const auto grow = [&](std::int32_t vertex, double size) {
    if (vertex >= 0 && vertex < mesh.gathered) largest[vertex] = std::max(largest[vertex], size);
  };
  for (const DisplayMesh::Face& face : mesh.faces) {
    const Patch& patch = scene.patches[face.patch];
    const Primitive& primitive = scene.primitives[patch.primitive];
    FaceSize of_face(primitive), of_patch(primitive);
    of_patch.add(patch.u0, patch.v0);
    of_patch.add(patch.u1, patch.v1);
    for (const std::int32_t vertex : mesh.corners_of(face))
      of_face.add(mesh.vertices[vertex].u, mesh.vertices[vertex].v);
    const double least = of_patch.over(target(primitive)) < kSmallFace ? 0 : kSmallFace;
    for (const std::int32_t vertex : mesh.corners_of(face))
      grow(vertex, std::max(least, of_face.over(target(primitive))));
  }
  for (const DisplayMesh::Facet& facet : mesh.facets) {
    const Primitive& primitive = scene.primitives[scene.patches[facet.patch].primitive + facet.facet];
    FaceSize size(primitive);
    size.add(0, 0);
    size.add(1, 1);
    for (const std::int32_t vertex : facet.corners) grow(vertex, std::min(size.over(target(primitive)), kSmallFace));
  }
  std::vector<std::uint8_t> factors;
  for (const double size : largest)
    factors.push_back(size < kSmallFace                          ? RayRows::kQuarter
                      : !scene.environment || size < kMediumFace ? 1
                      : size < kLargeFace                        ? kMediumFaceFactor
                                                                 : kLargeFaceFactor);
  return factors;
}

/// Finds neighbours of faces: faces with a number near theirs that share a vertex with them. No surface stands between
/// such faces.
class FaceNeighbours {
 public:
  explicit FaceNeighbours(const DisplayMesh& mesh) : behind_(mesh.faces.size()) {
    for (std::int32_t i = 0; i < mesh.elements(); ++i)
      for (int k = 1; k <= std::min(kFarthest, i); ++k)
        if (touch(mesh.corners_of(mesh.faces[i]), mesh.corners_of(mesh.faces[i - k])))
          behind_[i] |= std::uint8_t(1 << k);
  }

  int operator()(std::int32_t i, DirectFactors::NeighbourList& near) const {
    int count = 0;
    for (int k = kFarthest; k > 0; --k)
      if (behind_[i] & 1 << k) near[count++] = i - k;
    for (int k = 1; k <= kFarthest && std::size_t(i + k) < behind_.size(); ++k)
      if (behind_[i + k] & 1 << k) near[count++] = i + k;
    return count;
  }

 private:
  static constexpr int kFarthest = 4;

  static bool touch(std::span<const std::int32_t> a, std::span<const std::int32_t> b) {
    return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
  }

  std::vector<std::uint8_t> behind_;  ///< [faces] Bit k: whether the k-th face before is a neighbour.
};

/// Casts and samples what `transport` lacks for the display solution. Returns the number of rays.
std::int64_t complete_display(const PatchSet& scene, const SolveConfig& config, int rays, Transport& transport,
                              Progress& progress) {
  const std::vector<Emitter> further = further_emitters(scene);
  const std::int64_t id = emitters_id(further);
  const auto has_lights = [&] {
    return transport.lights_id == id && (id == 0 || !transport.display->lights.starts.empty());
  };
  const auto is_complete = [&] {
    return transport.display && has_lights() &&
           std::all_of(transport.emitters.begin(), transport.emitters.end(),
                       [](const Transport::Emitter& e) { return !e.display.empty(); });
  };
  if (is_complete()) return 0;
  const RayScene ray_scene(scene);
  std::int64_t cast = 0, mesh_rays = 0;
  if (!transport.display) {
    begin_part(SolvePart::display_rows, config, progress);
    cast = cast_display(scene, ray_scene, config, rays, transport.display.emplace(), mesh_rays, progress);
    cast += mesh_rays;
  }
  if (!has_lights()) {
    const std::vector<Patch> points = receivers(scene, transport.display->mesh);
    transport.display->lights =
        LightSampler(scene, ray_scene, further, display_seed(config)).sample(points, {}, light_rays(rays), cast);
    transport.lights_id = id;
  }
  begin_part(SolvePart::display_light, config, progress);
  const DisplayMesh& mesh = transport.display->mesh;
  const std::vector<Patch> faces = face_patches(scene, mesh);
  const FaceNeighbours neighbours(mesh);
  const DirectFactors direct(
      scene, ray_scene, faces, [&](std::int32_t i, auto& near) { return neighbours(i, near); }, display_seed(config));
  const std::vector<Emitter> emitters = explicit_emitters(scene);
  for (std::size_t k = 0; k < emitters.size(); ++k) {
    if (k == transport.emitters.size())
      transport.emitters.push_back({emitters[k].first_patch, emitters[k].patches, {}, {}});
    if (transport.emitters[k].display.empty()) {
      Transport::Emitter sampled = direct.sample(emitters[k], emitters.size(), rays / kVertexRaysPerShadowRay, cast);
      transport.emitters[k].display = std::move(sampled.factors);
      transport.emitters[k].display_tints = std::move(sampled.tints);
    }
    progress.update(double(k + 1) / double(emitters.size()), "direct light of the display solution");
  }
  transport.changed = true;
  return cast;
}

}  // namespace

int display_rays(int rays) {
  return std::max(std::min(rays, kMinVertexRays), rays / kPatchRaysPerVertexRay);
}

std::int64_t cast_display(const PatchSet& scene, const RayScene& ray_scene, const SolveConfig& config, int rays,
                          Transport::Display& display, std::int64_t& mesh_rays, Progress& progress, Shard shard) {
  const std::uint64_t seed = display_seed(config);
  display.mesh = build_display_mesh(scene, ray_scene, PatchLookup(scene), seed, mesh_rays);
  const std::vector<Patch> points = receivers(scene, display.mesh);
  const Elements elements(scene, display.mesh);
  const std::vector<std::uint8_t> factors = ray_factors(scene, display.mesh);
  return RayRows(scene, ray_scene, points, elements, seed, false, factors).cast(rays, display.rows, progress, shard);
}

void add_display_solution(const PatchSet& scene, const SolveConfig& config, Transport& transport, EnergyField& energy,
                          Progress& progress) {
  if (scene.light_groups.empty()) return;
  energy.rays +=
      complete_display(scene, config, display_rays(std::max(config.rays, transport.rays)), transport, progress);
  const SpectrumField difference = gather_display(scene, transport, energy.groups);
  if (energy.estimate) add_discretisation_error(scene, transport, difference, kDisplayPasses, energy);
  energy.display = transport.display->mesh;
}

}  // namespace patchlight

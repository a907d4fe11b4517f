#include "solver/display_solution.h"

#include <algorithm>

#include "pipeline/optics/elements.h"
#include "pipeline/optics/material_shader.h"
#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/random.h"
#include "pipeline/optics/smooth_normals.h"
#include "pipeline/optics/texture_lookup.h"
#include "solver/direct_factors.h"
#include "solver/display_mesh_builder.h"
#include "solver/linear_system.h"
#include "solver/patch_interpolation.h"
#include "solver/ray_rows.h"
#include "solver/transport_builder.h"

namespace patchlight {

namespace {

constexpr int kOfPatch = 2;  // rays of a patch for one of a vertex: there are many vertices where it matters,
constexpr int kLeast = 128;  // but few rays of one show as blotches
constexpr int kFewer = 4;    // of a vertex, for one of those that ask for the direct light of an element
constexpr int kPasses = 3;   // the first sees whole patches only; the third is for what stands on them

int rays_of_vertex(int rays) {
  return std::max(std::min(rays, kLeast), rays / kOfPatch);
}

/// Vertices that gather, as patches of no size, with the smooth normals of curved meshes.
std::vector<Patch> receivers(const PatchSet& scene, const DisplayMesh& mesh) {
  const SmoothNormals normals(scene);
  std::vector<Patch> points;
  for (const auto& vertex : std::span(mesh.vertices).first(mesh.gathered)) {
    Patch& point =
        points.emplace_back(part_of(scene, scene.patches[vertex.patch], vertex.u, vertex.v, vertex.u, vertex.v));
    point.normal = normals(point.primitive, vertex.u, vertex.v, point.normal);
  }
  return points;
}

/// Leaves stand in the order of their places, as far as they can in a row.
int row_neighbours(const std::vector<Patch>& leaves, std::int32_t i, DirectFactors::Near& near) {
  int count = 0;
  for (std::int32_t j = std::max(0, i - 4); j <= std::min(std::int32_t(leaves.size()) - 1, i + 4); ++j)
    if (j != i && leaves[j].primitive == leaves[i].primitive) near[count++] = j;
  return count;
}

std::int64_t complete(const PatchSet& scene, const SolveConfig& config, int rays, Transport& transport,
                      Progress& progress) {
  const auto is_complete = [&] {
    return transport.display && std::all_of(transport.emitters.begin(), transport.emitters.end(),
                                            [](const Transport::Emitter& e) { return !e.display.empty(); });
  };
  if (is_complete()) return 0;
  const RayScene ray_scene(scene);
  const std::uint64_t seed = scramble(std::uint64_t(config.seed));
  std::int64_t cast = 0;
  if (!transport.display) {
    auto& display = transport.display.emplace();
    display.mesh = build_display_mesh(scene, ray_scene, PatchLookup(scene), seed, cast);
    const std::vector<Patch> points = receivers(scene, display.mesh);
    const Elements elements(scene, ray_scene, display.mesh);
    cast +=
        RayRows(scene, ray_scene, points, elements, seed, RayRows::Halves::together).cast(rays, display.rows, progress);
  }
  const std::vector<Patch> leaves = leaf_patches(scene, transport.display->mesh);
  const DirectFactors direct(
      scene, ray_scene, leaves, [&](std::int32_t i, auto& near) { return row_neighbours(leaves, i, near); }, seed);
  const std::vector<Emitter> emitters = emitters_apart(scene);
  for (std::size_t k = 0; k < emitters.size(); ++k) {
    if (k == transport.emitters.size())
      transport.emitters.push_back({emitters[k].first_patch, emitters[k].patches, {}, {}});
    if (transport.emitters[k].display.empty())
      transport.emitters[k].display = direct.sample(emitters[k], emitters.size(), rays / kFewer, cast).factors;
    progress.update(double(k + 1) / double(emitters.size()), "direct light of the display solution");
  }
  transport.changed = true;
  return cast;
}

/// Of elements of leaves, as textures and shaders have it there. Shape: [mesh.elements].
SpectrumField leaf_reflectance(const PatchSet& scene, const DisplayMesh& mesh) {
  constexpr int kAcross = 4;
  std::vector<MaterialShader> shaders = compile_shaders(scene);
  SpectrumField reflectance;
  for (const Patch& leaf : leaf_patches(scene, mesh)) {
    const Primitive& primitive = scene.primitives[leaf.primitive];
    const bool shaded = primitive.shader >= 0 && shaders[primitive.shader].reflects();
    Spectrum sum(leaf.reflectance);
    if (shaded || primitive.texture >= 0) {
      sum = Spectrum();
      const PatchSampler sampler(primitive, leaf);
      for (int k = 0; k < kAcross * kAcross; ++k) {
        const Imath::V2d at = sampler.uv((float(k % kAcross) + 0.5f) / kAcross, (float(k / kAcross) + 0.5f) / kAcross);
        sum += Spectrum(shaded ? shaded_reflectance(scene, shaders[primitive.shader], leaf.primitive, at.x, at.y)
                               : textured_reflectance(scene, leaf.primitive, at.x, at.y));
      }
      sum *= Spectrum(1.0 / (kAcross * kAcross));
    }
    reflectance.push_back(sum);
  }
  return reflectance;
}

/// One light group's display solution in the making.
class Gather {
 public:
  Gather(const PatchSet& scene, const Transport& transport, const FormFactorRows& rows,
         const SpectrumField& leaf_reflectance, EnergyField::Group& group)
      : scene_(scene),
        transport_(transport),
        mesh_(transport.display->mesh),
        rows_(rows),
        leaf_reflectance_(leaf_reflectance),
        group_(group),
        patches_(scene.patches.size()),
        radiosity_(patches_ + mesh_.elements) {}

  void run() {
    emit();
    interpolate_photons();
    for (std::size_t i = 0; i < patches_; ++i)
      radiosity_[i] =
          Spectrum(scene_.patches[i].reflectance) * (Spectrum(group_.direct[i]) + Spectrum(group_.indirect[i]));
    for_each_element([&](std::size_t patch, std::int32_t element, auto) { set_element(element, from_patch(patch)); });
    gather();
    for (int more = 1; more < kPasses; ++more) {
      for_each_element([&](std::size_t, std::int32_t element, std::span<const std::int32_t> corners) {
        Spectrum sum;
        for (const std::int32_t corner : corners) sum += at_vertex(corner);
        set_element(element, sum * Spectrum(1.0 / double(corners.size())));
      });
      gather();
    }
    group_.display = to_colors(at_vertices_, group_.name);
  }

 private:
  /// Light of emitters: of those apart, at leaves and by way of mirrors; of others, wherever rays end on them.
  void emit() {
    const std::size_t count = radiosity_.size();
    others_.resize(count);
    apart_.resize(count);
    direct_.resize(mesh_.elements);
    for (std::size_t i = 0; i < patches_; ++i)
      if (is_of_group(i)) others_[i] = Spectrum(scene_.patches[i].emission);
    for (const auto& emitter : transport_.emitters) {
      for (std::int32_t j = emitter.first_patch; j < emitter.first_patch + emitter.patches; ++j)
        std::swap(apart_[j], others_[j]);
      const Spectrum exitance = apart_[emitter.first_patch];
      if (exitance.sum() == 0) continue;
      for (std::int32_t k = 0; k < mesh_.elements; ++k)
        direct_[k] += exitance * Spectrum(0.5 * (emitter.display[2 * k] + emitter.display[2 * k + 1]));
    }
    for_each_element([&](std::size_t patch, std::int32_t element, auto) {
      apart_[patches_ + element] = apart_[patch];
      others_[patches_ + element] = others_[patch];
    });
  }

  /// Caustics are patches' means, here as where patches are whole.
  void interpolate_photons() {
    if (group_.by_photons.empty()) return;
    const PatchLookup lookup(scene_);
    for (const auto& vertex : std::span(mesh_.vertices).first(mesh_.gathered))
      by_photons_.push_back(interpolate(scene_, lookup, vertex.patch, vertex.u, vertex.v, group_.by_photons));
  }

  bool is_of_group(std::size_t i) const {
    const std::int32_t group = scene_.primitives[scene_.patches[i].primitive].light_group;
    return group >= 0 && scene_.light_groups[group] == group_.name;
  }

  void gather() {
    SpectrumField sent = others_, deviation(mesh_.gathered);
    for (std::size_t i = 0; i < sent.size(); ++i) sent[i] += radiosity_[i];
    at_vertices_.assign(mesh_.gathered, Spectrum());
    rows_.receive(sent, at_vertices_);
    if (!group_.by_photons.empty()) {
      for (std::int32_t i = 0; i < mesh_.gathered; ++i) at_vertices_[i] += by_photons_[i];
      return;
    }
    if (transport_.display->rows.mirrored.empty()) return;
    SpectrumField by_mirrors(mesh_.gathered);
    rows_.receive_mirrored(apart_, by_mirrors, deviation);
    for (std::int32_t i = 0; i < mesh_.gathered; ++i) at_vertices_[i] += by_mirrors[i];
  }

  /// Calls act(patch, element, the vertices that the element lies between).
  template <class Act>
  void for_each_element(Act act) const {
    std::vector<std::int32_t> patch_of(mesh_.cells.size(), -1);
    for (std::size_t i = 0; i < patches_; ++i)
      if (mesh_.roots[i] >= 0) patch_of[mesh_.roots[i]] = std::int32_t(i);
    for (std::size_t i = 0; i < mesh_.cells.size(); ++i) {
      const DisplayMesh::Cell& cell = mesh_.cells[i];
      if (cell.children < 0) {
        const std::span<const std::int32_t> corners(cell.corners);
        for (int k = 0; k < cell.elements(); ++k)
          act(std::size_t(patch_of[i]), cell.leaf + k, cell.cut ? corners.subspan(k, 1) : corners);
        continue;
      }
      for (int k = 0; k < 4; ++k) patch_of[cell.children + k] = patch_of[i];
    }
  }

  void set_element(std::int32_t element, const Spectrum& irradiance) {
    radiosity_[patches_ + element] = leaf_reflectance_[element] * (direct_[element] + irradiance);
  }

  Spectrum from_patch(std::size_t i) const {
    Spectrum sum(group_.indirect[i]);
    if (!group_.direct_by_rows.empty()) sum += Spectrum(group_.direct_by_rows[i]);
    return sum;
  }

  Spectrum at_vertex(std::int32_t i) const {
    if (i < mesh_.gathered) return at_vertices_[i];
    const std::size_t k = i - (mesh_.vertices.size() - mesh_.midpoints.size());
    if (k >= mesh_.midpoints.size()) return from_patch(mesh_.vertices[i].patch);
    return (at_vertex(mesh_.midpoints[k][0]) + at_vertex(mesh_.midpoints[k][1])) * Spectrum(0.5);
  }

  const PatchSet& scene_;
  const Transport& transport_;
  const DisplayMesh& mesh_;
  const FormFactorRows& rows_;
  const SpectrumField& leaf_reflectance_;
  EnergyField::Group& group_;
  const std::size_t patches_;
  SpectrumField radiosity_;       ///< [elements], reflected.
  SpectrumField apart_, others_;  ///< [elements], emitted.
  SpectrumField by_photons_;      ///< [gathered], of emitters apart; empty: rows tell it.
  SpectrumField direct_;          ///< [mesh elements], of emitters apart.
  SpectrumField at_vertices_;     ///< [gathered].
};

}  // namespace

void add_display_solution(const PatchSet& scene, const SolveConfig& config, Transport& transport, EnergyField& energy,
                          Progress& progress) {
  if (scene.light_groups.empty()) return;
  energy.rays += complete(scene, config, rays_of_vertex(std::max(config.rays, transport.rays)), transport, progress);
  const FormFactorRows rows(transport.display->rows);
  const SpectrumField reflectance = leaf_reflectance(scene, transport.display->mesh);
  for (auto& group : energy.groups) Gather(scene, transport, rows, reflectance, group).run();
  energy.display = transport.display->mesh;
}

}  // namespace patchlight

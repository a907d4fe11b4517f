#include "solver/display_gather.h"

#include <algorithm>
#include <span>

#include "pipeline/optics/cutouts.h"
#include "pipeline/optics/direct_light.h"
#include "pipeline/optics/elements.h"
#include "pipeline/optics/material_shader.h"
#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/texture_lookup.h"
#include "solver/form_factor_rows.h"
#include "solver/linear_system.h"
#include "solver/patch_interpolation.h"

namespace patchlight {

namespace {

constexpr int kPasses = 3;  // the first sees whole patches only; the third is for what stands on them

/// Of elements of leaves, as textures and shaders have it there. Shape: [mesh.elements].
SpectrumField leaf_reflectance(const PatchSet& scene, const DisplayMesh& mesh) {
  constexpr int kAcross = 4;
  std::vector<MaterialShader> shaders = compile_shaders(scene);
  SpectrumField reflectance;
  for (const Patch& leaf : leaf_patches(scene, mesh)) {
    const Primitive& primitive = scene.primitives[leaf.primitive];
    const bool shaded = primitive.shader >= 0 && shaders[primitive.shader].reflects();
    Spectrum sum(leaf.reflectance);
    if (shaded || is_colored(scene, leaf.primitive)) {
      sum = Spectrum();
      const PatchSampler sampler(primitive, leaf);
      const int across = leaf.u0 == leaf.u1 ? 1 : kAcross;  // a corner is of no size
      int count = 0;
      for (int k = 0; k < across * across; ++k) {
        const Imath::V2d at =
            sampler.uv((float(k % across) + 0.5f) / float(across), (float(k / across) + 0.5f) / float(across));
        if (primitive.mask >= 0 && !is_there(scene, leaf.primitive, at.x, at.y)) continue;
        ++count;
        sum += Spectrum(shaded ? shaded_reflectance(scene, shaders[primitive.shader], leaf.primitive, at.x, at.y)
                               : colored_reflectance(scene, leaf.primitive, at.x, at.y));
      }
      sum = count > 0 ? sum * Spectrum(1.0 / count) : Spectrum(leaf.reflectance);
    }
    reflectance.push_back(sum);
  }
  return reflectance;
}

/// The mesh's elements, each with its patch and the vertices that it lies between.
class LeafElements {
 public:
  LeafElements(const PatchSet& scene, const DisplayMesh& mesh) : cells_(mesh.cells), patch_of_(mesh.cells.size(), -1) {
    for (std::size_t i = 0; i < scene.patches.size(); ++i)
      if (mesh.roots[i] >= 0) patch_of_[mesh.roots[i]] = std::int32_t(i);
    for (std::size_t i = 0; i < cells_.size(); ++i)
      for (int k = 0; k < 4 && cells_[i].children >= 0; ++k) patch_of_[cells_[i].children + k] = patch_of_[i];
  }

  /// Calls act(patch, element, vertices).
  template <class Act>
  void for_each(Act act) const {
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const DisplayMesh::Cell& cell = cells_[i];
      const std::span<const std::int32_t> corners(cell.corners);
      for (int k = 0; k < cell.elements(); ++k)
        act(std::size_t(patch_of_[i]), cell.leaf + k, cell.cut ? corners.subspan(k, 1) : corners);
    }
  }

 private:
  const std::vector<DisplayMesh::Cell>& cells_;
  std::vector<std::int32_t> patch_of_;  ///< [cells].
};

/// One light group's display solution in the making.
class Gather {
 public:
  Gather(const PatchSet& scene, const Transport& transport, const std::vector<Emitter>& emitters,
         const LeafElements& leaves, const SpectrumField& leaf_reflectance, EnergyField::Group& group)
      : scene_(scene),
        transport_(transport),
        mesh_(transport.display->mesh),
        emitters_(emitters),
        leaves_(leaves),
        leaf_reflectance_(leaf_reflectance),
        group_(group),
        light_group_(std::int32_t(std::find(scene.light_groups.begin(), scene.light_groups.end(), group.name) -
                                  scene.light_groups.begin())),
        patches_(scene.patches.size()),
        sent_(patches_ + mesh_.elements) {
    emit();
    send_sky();
    interpolate_photons();
  }

  /// What rows are to gather: in the first pass of patches, then of what the pass before found at the leaves.
  FormFactorRows::Exchange begin_pass() {
    if (at_vertices_.empty()) {
      for (std::size_t i = 0; i < patches_; ++i)
        sent_[i] = others_[i] + Spectrum(scene_.patches[i].reflectance) *
                                    (Spectrum(group_.direct[i]) + Spectrum(group_.indirect[i]));
      leaves_.for_each([&](std::size_t patch, std::int32_t element, auto) { send(patch, element, from_patch(patch)); });
      at_vertices_.resize(mesh_.gathered);
    } else {
      leaves_.for_each([&](std::size_t patch, std::int32_t element, std::span<const std::int32_t> corners) {
        Spectrum sum;
        for (const std::int32_t corner : corners) sum += at_vertex(corner);
        send(patch, element, sum * Spectrum(1.0 / double(corners.size())));
      });
    }
    return {&sent_, &at_vertices_};
  }

  /// Adds what comes from emitters by way of mirrors.
  void end_pass(const FormFactorRows& rows) {
    if (!group_.by_photons.empty()) {
      for (std::int32_t i = 0; i < mesh_.gathered; ++i) at_vertices_[i] += by_photons_[i];
    } else if (!transport_.display->rows.mirrored.empty()) {
      SpectrumField by_mirrors(mesh_.gathered), deviation(mesh_.gathered);
      rows.receive_mirrored(emitted_apart(), by_mirrors, deviation);
      for (std::int32_t i = 0; i < mesh_.gathered; ++i) at_vertices_[i] += by_mirrors[i];
    }
  }

  void finish() { group_.display = to_colors(at_vertices_, group_.name); }

 private:
  /// Light of emitters: of those apart, at leaves; of others, wherever rays end on them.
  void emit() {
    others_.resize(patches_);
    direct_.resize(mesh_.elements);
    for (std::size_t i = 0; i < patches_; ++i)
      if (is_of_group(i)) others_[i] = Spectrum(scene_.patches[i].emission);
    for (std::size_t e = 0; e < emitters_.size(); ++e) {
      const Transport::Emitter& emitter = transport_.emitters[e];
      const Spectrum exitance =
          emitters_[e].light >= 0 ? strength_of(scene_.lights[emitters_[e].light]) : others_[emitter.first_patch];
      std::fill_n(others_.begin() + emitter.first_patch, emitter.patches, Spectrum());
      if (exitance.sum() == 0) continue;
      for (std::int32_t k = 0; k < mesh_.elements; ++k)
        direct_[k] += exitance * Spectrum(0.5 * (emitter.display[2 * k] + emitter.display[2 * k + 1]));
    }
  }

  Spectrum strength_of(const Light& light) const {
    return light.light_group == light_group_ ? Spectrum(light.strength) : Spectrum();
  }

  void send_sky() {
    if (!scene_.environment) return;
    const Environment& sky = *scene_.environment;
    const bool own = sky.light_group == light_group_;
    for (const Color& cell : sky.cells) sent_.push_back(own ? Spectrum(cell) * Spectrum(kPi) : Spectrum());
  }

  /// What patches and their elements emit that are sampled apart.
  SpectrumField emitted_apart() const {
    SpectrumField apart(sent_.size());
    for (const auto& emitter : transport_.emitters)
      for (std::int32_t j = emitter.first_patch; j < emitter.first_patch + emitter.patches; ++j)
        if (is_of_group(j)) apart[j] = Spectrum(scene_.patches[j].emission);
    leaves_.for_each([&](std::size_t patch, std::int32_t element, auto) { apart[patches_ + element] = apart[patch]; });
    return apart;
  }

  /// Caustics are patches' means, here as where patches are whole.
  void interpolate_photons() {
    if (group_.by_photons.empty()) return;
    const PatchLookup lookup(scene_);
    for (const auto& vertex : std::span(mesh_.vertices).first(mesh_.gathered))
      by_photons_.push_back(interpolate(scene_, lookup, vertex.patch, vertex.u, vertex.v, group_.by_photons));
  }

  bool is_of_group(std::size_t i) const {
    return scene_.primitives[scene_.patches[i].primitive].light_group == light_group_;
  }

  void send(std::size_t patch, std::int32_t element, const Spectrum& irradiance) {
    sent_[patches_ + element] = others_[patch] + leaf_reflectance_[element] * (direct_[element] + irradiance);
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
  const std::vector<Emitter>& emitters_;  ///< Those of `transport_`.
  const LeafElements& leaves_;
  const SpectrumField& leaf_reflectance_;
  EnergyField::Group& group_;
  const std::int32_t light_group_;
  const std::size_t patches_;
  SpectrumField sent_;         ///< [elements]: radiosity; behind them, that of the environment's cells.
  SpectrumField others_;       ///< [patches], emitted by those that are not sampled apart.
  SpectrumField by_photons_;   ///< [gathered], of emitters apart; empty: rows tell it.
  SpectrumField direct_;       ///< [mesh elements], of emitters apart.
  SpectrumField at_vertices_;  ///< [gathered]; empty before the first pass.
};

}  // namespace

void gather_display(const PatchSet& scene, const Transport& transport, std::vector<EnergyField::Group>& groups) {
  const FormFactorRows rows(transport.display->rows);
  const std::vector<Emitter> emitters = emitters_apart(scene);
  const LeafElements leaves(scene, transport.display->mesh);
  const SpectrumField reflectance = leaf_reflectance(scene, transport.display->mesh);
  for (std::size_t first = 0; first < groups.size(); first += FormFactorRows::kSideBySide) {
    std::vector<Gather> gathers;
    for (std::size_t g = first; g < std::min(groups.size(), first + FormFactorRows::kSideBySide); ++g)
      gathers.emplace_back(scene, transport, emitters, leaves, reflectance, groups[g]);
    for (int pass = 0; pass < kPasses; ++pass) {
      std::vector<FormFactorRows::Exchange> fields;
      for (Gather& gather : gathers) fields.push_back(gather.begin_pass());
      rows.receive(fields, nullptr, FormFactorRows::Precision::single);
      for (Gather& gather : gathers) gather.end_pass(rows);
    }
    for (Gather& gather : gathers) gather.finish();
  }
}

}  // namespace patchlight

#include "solver/display/display_gather.h"

#include <algorithm>
#include <span>

#include "pipeline/optics/lights/direct_light.h"
#include "solver/direct/coat_light.h"
#include "solver/display/display_faces.h"
#include "solver/display/vertex_filter.h"
#include "solver/form_factors/coated_rows.h"
#include "solver/form_factors/row_scattering.h"
#include "solver/linear/form_factor_rows.h"
#include "solver/linear/linear_system.h"
#include "solver/linear/patch_interpolation.h"

namespace patchlight {

namespace {

/// What surfaces send out towards the rays of rows, over their irradiance.
struct Reflectances {
  Scattering patches;                         ///< See row_scattering(). Shape: [patches].
  SpectrumField faces;                        ///< [mesh elements]
  std::vector<Scattering::Passage> passages;  ///< To faces, from elements.
  CoatLight coats;
  bool metals;

  Reflectances(const PatchSet& scene, const Transport& transport, const DisplayMesh& mesh)
      : patches(row_scattering(scene, true)),
        faces(face_reflectance(scene, mesh)),
        passages(face_passages(scene, mesh)),
        coats(scene, transport.lights),
        metals(has_metals(scene)) {
    for (std::int32_t f = 0; f < mesh.elements(); ++f)
      faces[f] *= seen_by_rows(scene, scene.patches[mesh.faces[f].patch], Color(1.0f), true);
  }
};

Color color(const Spectrum& s) {
  return {float(s.c[0]), float(s.c[1]), float(s.c[2])};
}

/// Display solution of one light group while it is gathered.
class Gather {
 public:
  Gather(const PatchSet& scene, const Transport& transport, const std::vector<Emitter>& emitters,
         const std::vector<Emitter>& further, const Reflectances& reflectances, EnergyField::Group& group,
         RadiosityTable& radiosity, std::size_t field)
      : scene_(scene),
        transport_(transport),
        mesh_(transport.display->mesh),
        emitters_(emitters),
        further_(further),
        reflectances_(reflectances),
        group_(group),
        light_group_(std::int32_t(std::find(scene.light_groups.begin(), scene.light_groups.end(), group.name) -
                                  scene.light_groups.begin())),
        patches_(scene.patches.size()),
        radiosity_(radiosity),
        field_(field) {
    set_emission();
    set_sky_radiosity();
    interpolate_photons();
  }

  /// Sets the radiosity to gather: in the first pass from patches, later from the previous pass's irradiance at faces.
  FormFactorRows::Output begin_pass() {
    if (at_vertices_.empty()) {
      SpectrumField irradiance;
      irradiance.reserve(patches_);
      for (std::size_t i = 0; i < patches_; ++i) irradiance.push_back(total_irradiance_of_patch(i));
      const SpectrumField exitance = reflectances_.patches.exitance(irradiance);
      for (std::size_t i = 0; i < patches_; ++i)
        radiosity_.set(field_, i,
                       gathered_emission_[i] + exitance[i] +
                           (group_.by_coats.empty() ? Spectrum() : Spectrum(group_.by_coats[i])));
      set_face_radiosities([&](std::int32_t f) { return irradiance_of_patch(mesh_.faces[f].patch); });
      at_vertices_.resize(mesh_.gathered);
    } else {
      set_face_radiosities([&](std::int32_t f) { return irradiance_of_face(mesh_.corners_of(mesh_.faces[f])); });
    }
    deviation_.resize(mesh_.gathered);
    return {&at_vertices_, &deviation_};
  }

  /// Adds specular reflections of sampled emitters.
  void end_pass(const FormFactorRows& rows) {
    for (std::size_t i = 0; i < over_metals_.size(); ++i) at_vertices_[i] += over_metals_[i];
    if (transport_.display->rows.mirrored.empty() || !reflectances_.metals) return;
    SpectrumField mirrored(mesh_.gathered), deviation(mesh_.gathered);
    rows.gather_mirrored(sampled_exitance(), mirrored, deviation);
    add(mirrored, at_vertices_);
    add(deviation, deviation_);
  }

  void filter(const VertexFilter& filter) { at_vertices_ = filter.apply(at_vertices_, deviation_); }

  void store_result() { group_.display = to_colors(at_vertices_, group_.name); }

  /// Adds the mean irradiance of divided patches minus that of the patches themselves. `exposure`: see
  /// exposure_of_vertices().
  void add_differences(const std::vector<float>& exposure, SpectrumField& differences) const {
    SpectrumField sums(patches_);
    std::vector<double> weights(patches_);
    for (const DisplayMesh::Face& face : mesh_.faces) {
      const std::int32_t patch = face.patch;
      const bool covered = !transport_.visible_fractions.empty() && transport_.visible_fractions[2 * patch] < 1;
      for (const std::int32_t corner : mesh_.corners_of(face)) {
        const double weight = double(face.part) / double(face.count) * (covered ? double(exposure[corner]) : 1.0);
        sums[patch] += irradiance_at_vertex(corner) * Spectrum(weight);
        weights[patch] += weight;
      }
    }
    for (std::size_t i = 0; i < patches_; ++i)
      if (weights[i] > 0) differences[i] += sums[i] * Spectrum(1 / weights[i]) - irradiance_of_patch(i);
  }

 private:
  /// Sets direct light of sampled emitters at faces, and the emission that rays gather from other emitters.
  void set_emission() {
    gathered_emission_.resize(patches_);
    direct_.assign(mesh_.elements(), Color(0.0f));
    if (reflectances_.coats.any()) by_coats_ = direct_;
    for (std::size_t i = 0; i < patches_; ++i)
      if (is_of_group(i)) gathered_emission_[i] = Spectrum(scene_.patches[i].emission);
    SpectrumField sampled(patches_);
    for (const Emitter& emitter : further_)
      for (std::int32_t i = emitter.first_patch; i < emitter.first_patch + emitter.patches; ++i)
        std::swap(sampled[i], gathered_emission_[i]);
    if (!further_.empty()) {
      SpectrumField at_vertices(mesh_.gathered);
      gather_lights(transport_.display->lights, sampled, at_vertices, nullptr);
      for (std::int32_t f = 0; f < mesh_.elements(); ++f) {
        const Spectrum direct = mean(mesh_.corners_of(mesh_.faces[f]), at_vertices, [&](std::size_t i) {
          return group_.sampled_direct.empty() ? Spectrum() : Spectrum(group_.sampled_direct[i]);
        });
        direct_[f] = color(direct);
        if (reflectances_.coats.any() && !reflectances_.metals)
          by_coats_[f] += color(direct * reflectances_.coats.further_factor(std::size_t(mesh_.faces[f].patch)));
      }
    }
    for (std::size_t e = 0; e < emitters_.size(); ++e) {
      const Transport::Emitter& emitter = transport_.emitters[e];
      const Color exitance = exitance_of(emitters_[e]);
      std::fill_n(gathered_emission_.begin() + emitter.first_patch, emitter.patches, Spectrum());
      if (exitance == Color(0.0f)) continue;
      for (std::int32_t k = 0; k < mesh_.elements(); ++k) {
        const Color direct = exitance * (emitter.displayed(2 * k) + emitter.displayed(2 * k + 1)) * 0.5f;
        direct_[k] += direct;
        if (!by_coats_.empty() && direct != Color(0.0f))
          by_coats_[k] +=
              color(Spectrum(direct) * reflectances_.coats.factor(emitters_[e], std::size_t(mesh_.faces[k].patch)));
      }
    }
  }

  /// Exitance of an explicitly sampled emitter; zero if it is in another group.
  Color exitance_of(const Emitter& emitter) const {
    if (emitter.light < 0)
      return is_of_group(emitter.first_patch) ? scene_.patches[emitter.first_patch].emission : Color(0.0f);
    const Light& light = scene_.lights[emitter.light];
    return light.light_group == light_group_ ? light.strength : Color(0.0f);
  }

  void set_sky_radiosity() {
    if (!scene_.environment) return;
    const Environment& sky = *scene_.environment;
    if (sky.light_group != light_group_) return;
    for (std::size_t k = 0; k < sky.cells.size(); ++k)
      radiosity_.set(field_, patches_ + mesh_.elements() + k, Spectrum(sky.cells[k]) * Spectrum(kPi));
  }

  /// Exitance of sampled patches and of their elements whose specular reflections no photons bring. Shape: [elements].
  SpectrumField sampled_exitance() const {
    SpectrumField exitance(radiosity_.elements());
    const auto add = [&](std::int32_t first, std::int32_t count) {
      for (std::int32_t j = first; j < first + count; ++j)
        if (is_of_group(j)) exitance[j] = Spectrum(scene_.patches[j].emission);
    };
    if (group_.over_metals.empty())
      for (const auto& emitter : transport_.emitters) add(emitter.first_patch, emitter.patches);
    for (const Emitter& emitter : further_) add(emitter.first_patch, emitter.patches);
    for (std::int32_t f = 0; f < mesh_.elements(); ++f) exitance[patches_ + f] = exitance[mesh_.faces[f].patch];
    return exitance;
  }

  /// Interpolates caustics, which are patch means, at the vertices.
  void interpolate_photons() {
    if (group_.over_metals.empty()) return;
    const PatchLookup lookup(scene_);
    for (const auto& vertex : std::span(mesh_.vertices).first(mesh_.gathered))
      over_metals_.push_back(interpolate(scene_, lookup, vertex.patch, vertex.u, vertex.v, group_.over_metals));
  }

  bool is_of_group(std::size_t i) const {
    return scene_.primitives[scene_.patches[i].primitive].light_group == light_group_;
  }

  /// irradiance(f): of a face, without the direct light of sampled emitters.
  template <class Irradiance>
  void set_face_radiosities(Irradiance irradiance) {
    for (std::int32_t f = 0; f < mesh_.elements(); ++f)
      radiosity_.set(field_, patches_ + f,
                     gathered_emission_[mesh_.faces[f].patch] +
                         reflectances_.faces[f] * (Spectrum(direct_[f]) + irradiance(f)) +
                         (by_coats_.empty() ? Spectrum() : Spectrum(by_coats_[f])));
    for (const Scattering::Passage& p : reflectances_.passages) {
      const std::int32_t face = p.from - std::int32_t(patches_);
      radiosity_.add(
          field_, patches_ + p.to,
          p.part * (face < 0 ? total_irradiance_of_patch(p.from) : Spectrum(direct_[face]) + irradiance(face)));
    }
  }

  Spectrum total_irradiance_of_patch(std::size_t i) const {
    return Spectrum(group_.direct[i]) + Spectrum(group_.indirect[i]);
  }

  Spectrum irradiance_of_patch(std::size_t i) const {
    Spectrum sum(group_.indirect[i]);
    if (!group_.gathered_direct.empty()) sum += Spectrum(group_.gathered_direct[i]);
    return sum;
  }

  Spectrum irradiance_of_face(std::span<const std::int32_t> corners) const {
    return mean(corners, at_vertices_, [&](std::size_t i) { return irradiance_of_patch(i); });
  }

  Spectrum irradiance_at_vertex(std::int32_t vertex) const { return irradiance_of_face({&vertex, 1}); }

  /// Mean of a field over some vertices. `gathered`: the field at vertices that gather light; of_patch(i): its value on
  /// patch i, for vertices that are interpolated from patches.
  template <class OfPatch>
  Spectrum mean(std::span<const std::int32_t> vertices, const SpectrumField& gathered, OfPatch of_patch) const {
    Spectrum sum;
    for (const std::int32_t i : vertices) {
      const std::size_t k = i - (mesh_.vertices.size() - mesh_.midpoints.size());
      if (i < mesh_.gathered)
        sum += gathered[i];
      else
        sum += k < mesh_.midpoints.size() ? mean(mesh_.midpoints[k], gathered, of_patch)
                                          : of_patch(std::size_t(mesh_.vertices[i].patch));
    }
    return sum * Spectrum(1.0 / double(vertices.size()));
  }

  const PatchSet& scene_;
  const Transport& transport_;
  const DisplayMesh& mesh_;
  const std::vector<Emitter>& emitters_;  ///< As in `transport_`.
  const std::vector<Emitter>& further_;   ///< See further_emitters().
  const Reflectances& reflectances_;
  EnergyField::Group& group_;
  const std::int32_t light_group_;
  const std::size_t patches_;
  RadiosityTable& radiosity_;  ///< [patches, mesh elements, environment cells].
  const std::size_t field_;
  SpectrumField gathered_emission_;  ///< [patches] Exitance of emitters that are not sampled.
  SpectrumField over_metals_;        ///< [gathered] Light of explicitly sampled emitters by metals; empty: none.
  std::vector<Color> direct_;        ///< [mesh elements] Direct irradiance by sampled emitters.
  std::vector<Color> by_coats_;      ///< [mesh elements] What coats reflect of it; empty: no coats.
  SpectrumField at_vertices_;        ///< [gathered]; empty before the first pass.
  SpectrumField deviation_;          ///< [gathered] Half the difference of the rows' sample sets.
};

}  // namespace

SpectrumField gather_display(const PatchSet& scene, const Transport& transport,
                             std::vector<EnergyField::Group>& groups) {
  SpectrumField differences(scene.patches.size());
  const std::vector<float> exposure = exposure_of_vertices(*transport.display);
  const FormFactorRows rows(transport.display->rows);
  const VertexFilter filter(scene, transport.display->mesh);
  const std::vector<Emitter> emitters = explicit_emitters(scene), further = further_emitters(scene);
  const Reflectances reflectances(scene, transport, transport.display->mesh);
  const std::size_t elements = scene.patches.size() + transport.display->mesh.elements() + scene.sky_cells();
  for (std::size_t first = 0; first < groups.size(); first += RadiosityTable::kMaxFields) {
    const std::size_t count = std::min(groups.size() - first, RadiosityTable::kMaxFields);
    RadiosityTable radiosity(count, elements, RadiosityTable::Precision::single);
    std::vector<Gather> gathers;
    for (std::size_t f = 0; f < count; ++f)
      gathers.emplace_back(scene, transport, emitters, further, reflectances, groups[first + f], radiosity, f);
    for (int pass = 0; pass < kDisplayPasses; ++pass) {
      std::vector<FormFactorRows::Output> outputs;
      for (Gather& gather : gathers) outputs.push_back(gather.begin_pass());
      rows.gather(radiosity, outputs);
      for (Gather& gather : gathers) gather.end_pass(rows);
    }
    for (Gather& gather : gathers) {
      gather.filter(filter);
      gather.add_differences(exposure, differences);
      gather.store_result();
    }
  }
  return differences;
}

}  // namespace patchlight

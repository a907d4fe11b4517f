#include "solver/methods/progressive_refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pipeline/model/error.h"
#include "pipeline/optics/lights/direct_light.h"
#include "solver/direct/direct_factors.h"
#include "solver/form_factors/sky_rows.h"
#include "solver/linear/irradiance_filter.h"

namespace patchlight {

namespace {

constexpr std::uint32_t kPacket = 16;      // rays are cast by sixteens
constexpr double kMostRays = 1 << 22;      // of one shot
constexpr int kRaysBesideHemicubes = 256;  // for each patch, by which lights without extent are looked at
constexpr double kOvershootUntil = 1e-2;  // of the residual: it saves a fifth of the shots until here, and costs beyond

double channel_sum(const Vec3d& c) {
  return c.x + c.y + c.z;
}
Vec3d positive(const Vec3d& c) {
  return {std::max(c.x, 0.0), std::max(c.y, 0.0), std::max(c.z, 0.0)};
}

/// Every k-th value and the last, some hundreds at most.
std::vector<double> thinned(const std::vector<double>& values) {
  constexpr std::size_t kMost = 500;
  const std::size_t step = values.size() / kMost + 1;
  std::vector<double> result;
  for (std::size_t i = 0; i + 1 < values.size(); i += step) result.push_back(values[i]);
  if (!values.empty()) result.push_back(values.back());
  return result;
}

struct Group {
  std::vector<Vec3d> direct;    ///< Irradiance of emitters that frames sample apart, W/m2.
  std::vector<Vec3d> gathered;  ///< Irradiance of the other emitters, W/m2.
  std::vector<Vec3d> indirect;  ///< Irradiance, W/m2.
  std::vector<Vec3d> unshot;    ///< Reflected and not passed on yet, W/m2.
  double emitted = 0.0;         ///< W, sum of channels; of lights without extent, what arrives.
  double source_norm = 0.0;     ///< Of rho D.
  double unshot_norm = 0.0;
  Vec3d ambient{0.0};  ///< Irradiance that the unshot light is going to cause on average, W/m2.
};

class Refinement {
 public:
  Refinement(const PatchSet& scene, const SolveConfig& config, FormFactorSource& form_factors)
      : scene_(scene),
        config_(config),
        form_factors_(form_factors),
        by_rays_(config.form_factors == "rays"),
        groups_(scene.light_groups.size()),
        power_(scene.patches.size()),
        used_(scene.patches.size()) {
    for (Group& group : groups_)
      for (auto* field : {&group.direct, &group.gathered, &group.indirect, &group.unshot})
        field->resize(power_.size(), Vec3d(0.0));
    for (const Patch& patch : scene.patches) {
      area_ += patch.covered_area();
      reflectance_ += Vec3d(patch.reflectance) * patch.covered_area();
      if (Group* group = emitting_group(patch))
        group->emitted += patch.covered_area() * channel_sum(Vec3d(patch.emission));
    }
    reflectance_ /= area_;
  }

  void add_lights();
  void add_sky(Progress& progress);
  void shoot_emitters(Progress& progress);
  void shoot_reflections(Progress& progress);
  EnergyField result() const;

 private:
  Group* emitting_group(const Patch& patch) {
    const std::int32_t index = scene_.primitives[patch.primitive].light_group;
    return index >= 0 && patch.emission != Color(0.0f) ? &groups_[index] : nullptr;
  }

  double rays_of(double share) const { return share * config_.rays * double(power_.size()); }

  /// A shot that carries `share` of what all groups emit, each counted as one.
  Shot make_shot(std::int32_t patch, double share) {
    Shot shot{patch, 0, used_[patch]};
    if (by_rays_) {
      const double packets = std::ceil(rays_of(share) / kPacket);
      shot.rays = std::uint32_t(std::clamp(packets, 1.0, kMostRays / kPacket)) * kPacket;
    }
    used_[patch] += by_rays_ ? shot.rays : 1;
    return shot;
  }

  /// Calls pass_on(shot, its row of form factors) for every shot, in order.
  template <class PassOn>
  void shoot(std::span<const Shot> shots, PassOn pass_on) {
    while (!shots.empty()) {
      const std::span<const Shot> batch = shots.first(form_factors_.batch(shots));
      const std::vector<std::span<const FormFactor>> rows = form_factors_.rows(batch);
      for (std::size_t k = 0; k < batch.size(); ++k) {
        pass_on(batch[k], rows[k]);
        rays_ += batch[k].rays;
      }
      shots_ += std::int64_t(batch.size());
      shots = shots.subspan(batch.size());
      Progress::check_interrupted();
    }
  }

  /// Gives `flux` (W) of a group out along a row.
  void pass_on(Group& group, std::vector<Vec3d>& irradiance, const Vec3d& flux, std::span<const FormFactor> row) {
    double received = 0;
    for (const FormFactor& f : row) {
      const Patch& patch = scene_.patches[f.patch];
      const Vec3d added = flux * (double(f.value) / patch.covered_area());
      irradiance[f.patch] += added;
      group.unshot[f.patch] += added * Vec3d(patch.reflectance);
      received += f.value;
    }
    shot_flux_ += channel_sum(positive(flux)) / group.emitted;
    received_flux_ += received * channel_sum(positive(flux)) / group.emitted;
  }

  void take_stock();
  std::vector<Shot> most_unshot();

  double residual() const {
    double largest = 0;
    for (const Group& group : groups_)
      if (group.source_norm > 0) largest = std::max(largest, group.unshot_norm / group.source_norm);
    return largest;
  }

  const PatchSet& scene_;
  const SolveConfig& config_;
  FormFactorSource& form_factors_;
  const bool by_rays_;
  std::vector<Group> groups_;
  std::vector<double> power_;        ///< Unshot power of each patch, over what its groups emit.
  std::vector<std::uint64_t> used_;  ///< Samples that each patch has used.
  double area_ = 0.0;                ///< m2
  Vec3d reflectance_{0.0};           ///< Mean over the area.
  double shot_flux_ = 0.0, received_flux_ = 0.0;
  std::int64_t shots_ = 0;
  std::int64_t rays_ = 0;
  std::vector<double> residuals_;  ///< Of what is unshot, before the first batch and after each.
};

/// What lights without extent bring straight: nothing shoots there, so patches look at them.
void Refinement::add_lights() {
  const RayScene ray_scene(scene_);
  const PatchLookup lookup(scene_);
  const DirectFactors factors(scene_, ray_scene, scene_.patches, grid_neighbours(scene_, lookup),
                              std::uint64_t(config_.seed));
  for (const Emitter& emitter : explicit_emitters(scene_)) {
    if (emitter.light < 0) continue;
    const Light& light = scene_.lights[emitter.light];
    Group& group = groups_[light.light_group];
    const int rays = by_rays_ ? config_.rays : kRaysBesideHemicubes;
    const std::vector<float> of_sample_sets = factors.sample(emitter, scene_.lights.size(), rays, rays_).factors;
    for (std::size_t i = 0; i < power_.size(); ++i) {
      const Patch& patch = scene_.patches[i];
      const Vec3d added =
          positive(Vec3d(light.strength) * (0.5 * (double(of_sample_sets[2 * i]) + of_sample_sets[2 * i + 1])));
      group.direct[i] += added;
      group.unshot[i] += added * Vec3d(patch.reflectance);
      group.emitted += patch.covered_area() * channel_sum(added);
    }
  }
}

/// The same of the environment.
void Refinement::add_sky(Progress& progress) {
  const Environment& sky = *scene_.environment;
  Group& group = groups_[sky.light_group];
  const RayScene ray_scene(scene_);
  const TransportRows seen = sky_rows(scene_, ray_scene, by_rays_ ? config_.rays : kRaysBesideHemicubes,
                                      std::uint64_t(config_.seed), rays_, progress);
  SpectrumField sent(power_.size() + sky.cells.size()), received(power_.size()), deviation(power_.size()), reflectance;
  for (std::size_t k = 0; k < sky.cells.size(); ++k) sent[power_.size() + k] = Spectrum(sky.cells[k]) * Spectrum(kPi);
  const FormFactorRows::Field field{&sent, {&received, &deviation}};
  FormFactorRows(seen).gather({&field, 1}, nullptr, FormFactorRows::Precision::full);
  for (const Patch& patch : scene_.patches) reflectance.emplace_back(patch.reflectance);
  received = IrradianceFilter(PatchLookup(scene_), scene_.primitives.size(), received, deviation, reflectance, received)
                 .apply(received);
  for (std::size_t i = 0; i < power_.size(); ++i) {
    const Patch& patch = scene_.patches[i];
    const Vec3d added = positive(Vec3d(received[i].c[0], received[i].c[1], received[i].c[2]));
    group.gathered[i] += added;
    group.unshot[i] += added * Vec3d(patch.reflectance);
    group.emitted += patch.covered_area() * channel_sum(added);
  }
}

void Refinement::shoot_emitters(Progress& progress) {
  if (!scene_.lights.empty()) add_lights();
  if (scene_.environment) add_sky(progress);
  // An emitter's light is seen directly: its hemicubes stand on many points, one for every 32 patches of the scene.
  const double points = double(power_.size()) / 32;
  std::vector<Shot> shots;
  std::vector<int> parts(power_.size());
  for (std::size_t i = 0; i < power_.size(); ++i) {
    const Patch& patch = scene_.patches[i];
    const Group* group = emitting_group(patch);
    if (!group) continue;
    const double share =
        patch.covered_area() * channel_sum(Vec3d(patch.emission)) / (group->emitted * double(groups_.size()));
    parts[i] = int(std::ceil(by_rays_ ? rays_of(share) / kMostRays : std::min(share * points, 64.0)));
    for (int k = 0; k < parts[i]; ++k) shots.push_back(make_shot(std::int32_t(i), share / parts[i]));
  }
  std::vector<char> separate(power_.size(), 0);
  for (const Emitter& emitter : explicit_emitters(scene_))
    std::fill_n(separate.begin() + emitter.first_patch, emitter.patches, 1);
  shoot(shots, [&](const Shot& shot, std::span<const FormFactor> row) {
    const Patch& patch = scene_.patches[shot.patch];
    Group& group = *emitting_group(patch);
    pass_on(group, separate[shot.patch] ? group.direct : group.gathered,
            Vec3d(patch.emission) * (patch.covered_area() / parts[shot.patch]), row);
    progress.update(0.0, "direct light");
  });
  take_stock();
  for (Group& group : groups_) group.source_norm = group.unshot_norm;
}

void Refinement::shoot_reflections(Progress& progress) {
  const double first = residual();
  residuals_ = {first};
  const std::int64_t most_shots = config_.max_shots * std::int64_t(power_.size());
  while (residual() > config_.tolerance && shots_ < most_shots) {
    const bool overshoot = !by_rays_ && residual() > kOvershootUntil;
    shoot(most_unshot(), [&](const Shot& shot, std::span<const FormFactor> row) {
      const Patch& patch = scene_.patches[shot.patch];
      for (Group& group : groups_) {
        Vec3d& unshot = group.unshot[shot.patch];
        if (unshot == Vec3d(0.0)) continue;
        Vec3d ahead(0.0);  // at most as much again, lest patches that shoot together overdo it
        for (int k = 0; overshoot && k < 3; ++k)
          ahead[k] = std::clamp(double(patch.reflectance[k]) * group.ambient[k], 0.0, std::max(unshot[k], 0.0));
        const Vec3d shot_now = unshot + ahead;
        unshot = -ahead;
        pass_on(group, group.indirect, shot_now * patch.covered_area(), row);
      }
    });
    take_stock();
    residuals_.push_back(residual());
    progress.update(std::log(first / std::max(residual(), 1e-300)) / std::log(first / config_.tolerance),
                    fmt::format("unshot {:.2g}, {} shots", residual(), shots_), rays_);
  }
  if (residual() > config_.tolerance)
    progress.warning(
        fmt::format("stopped after {} shots at a residual of {:.2g}: raise solve.max_shots ({}) or "
                    "solve.tolerance ({})",
                    shots_, residual(), config_.max_shots, config_.tolerance));
}

/// Sums up what is unshot.
void Refinement::take_stock() {
  std::fill(power_.begin(), power_.end(), 0.0);
  const double kept = shot_flux_ > 0 ? received_flux_ / shot_flux_ : 0.0;
  for (Group& group : groups_) {
    double square = 0;
    Vec3d sum(0.0);
    for (std::size_t i = 0; i < power_.size(); ++i) {
      const Vec3d& unshot = group.unshot[i];
      const double area = scene_.patches[i].covered_area();
      square += area * unshot.length2();
      sum += unshot * area;
      if (group.emitted > 0) power_[i] += area * std::abs(channel_sum(unshot)) / group.emitted;
    }
    group.unshot_norm = std::sqrt(square);
    group.ambient = positive(sum * (kept / area_) / (Vec3d(1.0) - reflectance_ * kept));
  }
}

/// The thirty-second part of all patches that has the most unshot power: choosing costs a shot O(1), and a batch is
/// large enough for threads to share.
std::vector<Shot> Refinement::most_unshot() {
  std::vector<std::int32_t> order(power_.size());
  std::iota(order.begin(), order.end(), 0);
  const std::size_t count = std::min(order.size(), std::max<std::size_t>(64, order.size() / 32));
  std::nth_element(
      order.begin(), order.begin() + std::ptrdiff_t(count) - 1, order.end(),
      [&](std::int32_t a, std::int32_t b) { return power_[a] != power_[b] ? power_[a] > power_[b] : a < b; });
  order.resize(count);
  std::sort(order.begin(), order.end());
  std::vector<Shot> shots;
  for (const std::int32_t i : order)
    if (power_[i] > 0) shots.push_back(make_shot(i, power_[i] / double(groups_.size())));
  return shots;
}

EnergyField Refinement::result() const {
  EnergyField energy;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Group& from = groups_[g];
    auto& to = energy.groups.emplace_back();
    to.name = scene_.light_groups[g];
    for (std::size_t i = 0; i < power_.size(); ++i) {
      const Vec3d direct = from.direct[i] + from.gathered[i];
      const bool receives_light = direct != Vec3d(0.0) || from.indirect[i] != Vec3d(0.0);
      to.direct.emplace_back(Vec3f(direct));
      to.gathered_direct.emplace_back(Vec3f(from.gathered[i]));
      to.indirect.emplace_back(Vec3f(positive(from.indirect[i] + (receives_light ? from.ambient : Vec3d(0.0)))));
      const Color sum = to.direct.back() + to.indirect.back();
      if (!std::isfinite(sum.x + sum.y + sum.z))
        throw Error(ExitCode::bad_data, "light group `" + to.name + "` is too strong for single precision", "energy.h5",
                    "give its emitters less, and frames more by `lights` or the exposure");
    }
    if (std::all_of(from.gathered.begin(), from.gathered.end(), [](const Vec3d& v) { return v == Vec3d(0.0); }))
      to.gathered_direct.clear();
  }
  energy.iterations = shots_;
  energy.rays = rays_;
  energy.residual = residual();
  energy.convergence.push_back({"", thinned(residuals_)});
  return energy;
}

}  // namespace

EnergyField progressive_refinement(const PatchSet& scene, const SolveConfig& config, FormFactorSource& form_factors,
                                   Progress& progress) {
  Refinement refinement(scene, config, form_factors);
  refinement.shoot_emitters(progress);
  refinement.shoot_reflections(progress);
  return refinement.result();
}

}  // namespace patchlight

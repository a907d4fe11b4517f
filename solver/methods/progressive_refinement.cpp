#include "solver/methods/progressive_refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solver/form_factors/row_scattering.h"
#include "solver/linear/linear_system.h"
#include "solver/methods/external_irradiance.h"
#include "solver/methods/refinement_state.h"

namespace patchlight {

namespace {

constexpr std::uint32_t kPacketRays = 16;
constexpr double kMaxShotRays = 1 << 22;
constexpr int kRaysBesideHemicubes = 256;    // shadow rays of a patch where form factors are by hemicubes
constexpr double kOvershootResidual = 1e-2;  // overshooting saves a fifth of the shots above it, and costs more below

Vec3d vector(const Spectrum& s) {
  return {s.c[0], s.c[1], s.c[2]};
}

double channel_sum(const Vec3d& c) {
  return c.x + c.y + c.z;
}

class Refinement {
 public:
  Refinement(const PatchSet& scene, const SolveConfig& config, FormFactorSource& form_factors)
      : scene_(scene),
        config_(config),
        form_factors_(form_factors),
        by_rays_(config.form_factors == "rays"),
        scattering_(row_scattering(scene, false)),
        passages_(scattering_),
        groups_(scene.light_groups.size()),
        power_(scene.patches.size()),
        used_(scene.patches.size()) {
    for (RefinedGroup& group : groups_)
      for (auto* field : {&group.direct, &group.sampled, &group.gathered, &group.indirect, &group.unshot})
        field->resize(power_.size(), Vec3d(0.0));
    for (std::size_t i = 0; i < power_.size(); ++i) {
      const Patch& patch = scene.patches[i];
      area_ += patch.covered_area();
      reflectance_ += vector(scattering_.albedo[i]) * patch.covered_area();
      if (RefinedGroup* group = emitting_group(patch))
        group->emitted += patch.covered_area() * channel_sum(Vec3d(patch.emission));
    }
    reflectance_ /= area_;
  }

  void add_external_light(Progress& progress);
  void shoot_emitters(Progress& progress);
  void shoot_reflections(Progress& progress);
  EnergyField result() const;

 private:
  RefinedGroup* emitting_group(const Patch& patch) {
    const std::int32_t index = scene_.primitives[patch.primitive].light_group;
    return index >= 0 && patch.emission != Color(0.0f) ? &groups_[index] : nullptr;
  }

  double rays_for(double share) const { return share * config_.rays * double(power_.size()); }

  /// A shot with `share` of the emitted power of all groups, each of which counts as 1.
  Shot make_shot(std::int32_t patch, double share) {
    Shot shot{patch, 0, used_[patch]};
    if (by_rays_) {
      const double packets = std::ceil(rays_for(share) / kPacketRays);
      shot.rays = std::uint32_t(std::clamp(packets, 1.0, kMaxShotRays / kPacketRays)) * kPacketRays;
    }
    used_[patch] += by_rays_ ? shot.rays : 1;
    return shot;
  }

  /// Calls distribute(shot, its row of form factors) for every shot, in order.
  template <class Distribute>
  void shoot(std::span<const Shot> shots, Distribute distribute) {
    while (!shots.empty()) {
      const std::span<const Shot> batch = shots.first(form_factors_.batch(shots));
      const std::vector<std::span<const FormFactor>> rows = form_factors_.rows(batch);
      for (std::size_t k = 0; k < batch.size(); ++k) {
        distribute(batch[k], rows[k]);
        rays_ += batch[k].rays;
      }
      shots_ += std::int64_t(batch.size());
      shots = shots.subspan(batch.size());
      Progress::check_interrupted();
    }
  }

  /// Distributes `flux` (W) of a group by a row of form factors.
  void distribute(RefinedGroup& group, std::vector<Vec3d>& irradiance, const Vec3d& flux,
                  std::span<const FormFactor> row) {
    double received = 0;
    for (const FormFactor& f : row) {
      const Patch& patch = scene_.patches[f.patch];
      const Vec3d added = flux * (double(f.value) / patch.covered_area());
      irradiance[f.patch] += added;
      reflect(group, f.patch, added);
      received += f.value;
    }
    shot_flux_ += channel_sum(positive(flux)) / group.emitted;
    received_flux_ += received * channel_sum(positive(flux)) / group.emitted;
  }

  /// Adds what patch i sends out of an irradiance to the unshot light.
  void reflect(RefinedGroup& group, std::int32_t i, const Vec3d& irradiance) {
    group.unshot[i] += irradiance * Vec3d(scene_.patches[i].total_reflectance());
    for (const Scattering::Passage& p : passages_.of(i)) group.unshot[p.to] += irradiance * vector(p.part);
  }

  void sum_unshot();
  std::vector<Shot> brightest_shots();

  double residual() const {
    double largest = 0;
    for (const RefinedGroup& group : groups_)
      if (group.source_norm > 0) largest = std::max(largest, group.unshot_norm / group.source_norm);
    return largest;
  }

  const PatchSet& scene_;
  const SolveConfig& config_;
  FormFactorSource& form_factors_;
  const bool by_rays_;
  const Scattering scattering_;
  const PassagesFrom passages_;
  std::vector<RefinedGroup> groups_;
  std::vector<double> power_;        ///< [n] Unshot power, over the emitted power of its groups.
  std::vector<std::uint64_t> used_;  ///< [n] Samples that the patch has used.
  double area_ = 0.0;                ///< m2
  Vec3d reflectance_{0.0};           ///< Area-weighted mean.
  double shot_flux_ = 0.0, received_flux_ = 0.0;
  std::int64_t shots_ = 0;
  std::int64_t rays_ = 0;
  std::vector<double> residuals_;  ///< Before the first batch and after each.
};

/// Adds the direct light of lights and the environment, which have no patches to shoot from.
void Refinement::add_external_light(Progress& progress) {
  if (scene_.lights.empty() && !scene_.environment) return;
  const ExternalIrradiance external(scene_, by_rays_ ? config_.rays : kRaysBesideHemicubes,
                                    std::uint64_t(config_.seed));
  const auto add = [&](RefinedGroup& group, std::vector<Vec3d> RefinedGroup::*direct,
                       const std::vector<Vec3d>& irradiance) {
    for (std::size_t i = 0; i < power_.size(); ++i) {
      const Patch& patch = scene_.patches[i];
      (group.*direct)[i] += irradiance[i];
      reflect(group, std::int32_t(i), irradiance[i]);
      group.emitted += patch.covered_area() * channel_sum(irradiance[i]);
    }
  };
  for (const Emitter& emitter : explicit_emitters(scene_))
    if (emitter.light >= 0)
      add(groups_[scene_.lights[emitter.light].light_group], &RefinedGroup::direct, external.of_light(emitter, rays_));
  if (scene_.environment)
    add(groups_[scene_.environment->light_group], &RefinedGroup::gathered, external.of_environment(rays_, progress));
}

void Refinement::shoot_emitters(Progress& progress) {
  add_external_light(progress);
  // Direct light shows the most detail: an emitter gets many hemicubes, all together one for every 32 patches.
  const double points = double(power_.size()) / 32;
  std::vector<Shot> shots;
  std::vector<int> shots_of_patch(power_.size());
  for (std::size_t i = 0; i < power_.size(); ++i) {
    const Patch& patch = scene_.patches[i];
    const RefinedGroup* group = emitting_group(patch);
    if (!group) continue;
    const double share =
        patch.covered_area() * channel_sum(Vec3d(patch.emission)) / (group->emitted * double(groups_.size()));
    shots_of_patch[i] = int(std::ceil(by_rays_ ? rays_for(share) / kMaxShotRays : std::min(share * points, 64.0)));
    for (int k = 0; k < shots_of_patch[i]; ++k) shots.push_back(make_shot(std::int32_t(i), share / shots_of_patch[i]));
  }
  std::vector<std::vector<Vec3d> RefinedGroup::*> receives(power_.size(), &RefinedGroup::gathered);
  for (const Emitter& emitter : explicit_emitters(scene_))
    std::fill_n(receives.begin() + emitter.first_patch, emitter.patches, &RefinedGroup::direct);
  for (const Emitter& emitter : further_emitters(scene_))
    std::fill_n(receives.begin() + emitter.first_patch, emitter.patches, &RefinedGroup::sampled);
  shoot(shots, [&](const Shot& shot, std::span<const FormFactor> row) {
    const Patch& patch = scene_.patches[shot.patch];
    RefinedGroup& group = *emitting_group(patch);
    distribute(group, group.*receives[shot.patch],
               Vec3d(patch.emission) * (patch.covered_area() / shots_of_patch[shot.patch]), row);
    progress.update(0.0, "direct light");
  });
  sum_unshot();
  for (RefinedGroup& group : groups_) group.source_norm = group.unshot_norm;
}

void Refinement::shoot_reflections(Progress& progress) {
  residuals_ = {residual()};
  const std::int64_t max_shots = config_.max_shots * std::int64_t(power_.size());
  while (residual() > config_.tolerance && shots_ < max_shots) {
    const bool overshoot = !by_rays_ && residual() > kOvershootResidual;
    shoot(brightest_shots(), [&](const Shot& shot, std::span<const FormFactor> row) {
      const Patch& patch = scene_.patches[shot.patch];
      for (RefinedGroup& group : groups_) {
        Vec3d& unshot = group.unshot[shot.patch];
        if (unshot == Vec3d(0.0)) continue;
        // At most the unshot light again, since the patches of a batch also light each other.
        Vec3d overshot = overshoot ? vector(scattering_.albedo[shot.patch]) * group.ambient : Vec3d(0.0);
        for (int k = 0; k < 3; ++k) overshot[k] = std::clamp(overshot[k], 0.0, std::max(unshot[k], 0.0));
        const Vec3d shot_now = unshot + overshot;
        unshot = -overshot;
        distribute(group, group.indirect, shot_now * patch.covered_area(), row);
      }
    });
    sum_unshot();
    residuals_.push_back(residual());
    progress.update(
        std::log(residuals_[0] / std::max(residual(), 1e-300)) / std::log(residuals_[0] / config_.tolerance),
        fmt::format("unshot {:.2g}, {} shots", residual(), shots_), rays_);
  }
  if (residual() > config_.tolerance)
    progress.warning(
        fmt::format("stopped after {} shots at a residual of {:.2g}: raise solve.max_shots ({}) or "
                    "solve.tolerance ({})",
                    shots_, residual(), config_.max_shots, config_.tolerance));
}

/// Updates the norms, powers and ambient terms of the unshot light.
void Refinement::sum_unshot() {
  std::fill(power_.begin(), power_.end(), 0.0);
  const double hit_fraction = shot_flux_ > 0 ? received_flux_ / shot_flux_ : 0.0;
  for (RefinedGroup& group : groups_) {
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
    group.ambient = positive(sum * (hit_fraction / area_) / (Vec3d(1.0) - reflectance_ * hit_fraction));
  }
}

/// Shots of the 1/32 of all patches with the most unshot power: selecting them costs O(1) a shot, and a batch is large
/// enough for all threads.
std::vector<Shot> Refinement::brightest_shots() {
  std::vector<std::int32_t> order(power_.size());
  std::iota(order.begin(), order.end(), 0);
  const std::size_t count = std::min(order.size(), std::max<std::size_t>(64, order.size() / 32));
  std::ranges::nth_element(order, order.begin() + std::ptrdiff_t(count) - 1, {},
                           [&](std::int32_t i) { return std::pair(-power_[i], i); });
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
    const RefinedGroup& from = groups_[g];
    auto& to = energy.groups.emplace_back();
    to.name = scene_.light_groups[g];
    const bool gathers = std::ranges::any_of(from.gathered, [](const Vec3d& v) { return v != Vec3d(0.0); });
    for (std::size_t i = 0; i < power_.size(); ++i) {
      const Vec3d direct = from.direct[i] + from.sampled[i] + from.gathered[i];
      const bool receives_light = direct != Vec3d(0.0) || from.indirect[i] != Vec3d(0.0);
      to.direct.emplace_back(Vec3f(direct));
      to.sampled_direct.emplace_back(Vec3f(from.sampled[i]));
      if (gathers) to.gathered_direct.emplace_back(Vec3f(from.gathered[i]));
      to.indirect.emplace_back(Vec3f(positive(from.indirect[i] + (receives_light ? from.ambient : Vec3d(0.0)))));
      const Color sum = to.direct.back() + to.indirect.back();
      if (!std::isfinite(sum.x + sum.y + sum.z)) throw_overflow(to.name);
    }
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

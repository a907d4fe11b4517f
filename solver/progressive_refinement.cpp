#include "solver/progressive_refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solver/ray_form_factors.h"

namespace patchlight {

namespace {

constexpr std::uint64_t kBatchRays = 1 << 20;

double channel_sum(const Vec3d& c) {
  return c.x + c.y + c.z;
}

struct Group {
  std::vector<Vec3d> direct;  ///< Irradiance, W/m2.
  std::vector<Vec3d> indirect;
  std::vector<Vec3d> unshot;  ///< Reflected and not passed on yet, W/m2.
  double emitted = 0.0;       ///< W, sum of channels.
  double source_norm = 0.0;   ///< Of rho D.
};

class Refinement {
 public:
  Refinement(const PatchSet& scene, const SolveConfig& config)
      : scene_(scene),
        config_(config),
        form_factors_(scene, std::uint64_t(config.seed)),
        groups_(scene.light_groups.size()),
        power_(scene.patches.size()),
        cast_(scene.patches.size()) {
    for (Group& group : groups_) {
      group.direct.resize(scene.patches.size(), Vec3d(0.0));
      group.indirect.resize(scene.patches.size(), Vec3d(0.0));
      group.unshot.resize(scene.patches.size(), Vec3d(0.0));
    }
    for (const Patch& patch : scene.patches)
      if (Group* group = group_of(patch)) group->emitted += patch.area * channel_sum(Vec3d(patch.emission));
  }

  void shoot_emitters(Progress& progress);
  void shoot_reflections(Progress& progress);
  EnergyField result() const;

 private:
  Group* group_of(const Patch& patch) {
    const std::int32_t index = scene_.primitives[patch.primitive].light_group;
    return index >= 0 && patch.emission != Color(0.0f) ? &groups_[index] : nullptr;
  }

  /// Rays for a shot that carries `share` of what a group emits.
  std::uint32_t ray_count(double share) const {
    const double wanted = share * config_.rays * double(scene_.patches.size());
    return std::uint32_t(std::clamp(std::ceil(wanted / RayPacket::kSize), 1.0, 65536.0)) * RayPacket::kSize;
  }

  Shot make_shot(std::int32_t patch, double share) {
    const Shot shot{patch, ray_count(share), cast_[patch]};
    cast_[patch] += shot.rays;
    return shot;
  }

  /// Calls pass_on(shot, ends of its rays) for every shot, in order.
  template <class PassOn>
  void cast(std::span<const Shot> shots, PassOn pass_on) {
    for (std::size_t begin = 0, end; begin < shots.size(); begin = end) {
      std::uint64_t rays = 0;
      for (end = begin; end < shots.size() && (end == begin || rays + shots[end].rays <= kBatchRays); ++end)
        rays += shots[end].rays;
      const std::vector<std::int32_t> ends = form_factors_.cast(shots.subspan(begin, end - begin));
      const std::int32_t* next = ends.data();
      for (const Shot& shot : shots.subspan(begin, end - begin)) {
        pass_on(shot, std::span(next, shot.rays));
        next += shot.rays;
      }
      rays_ += std::int64_t(rays);
      shots_ += std::int64_t(end - begin);
      Progress::check_interrupted();
    }
  }

  void receive(Group& group, std::vector<Vec3d>& irradiance, std::int32_t j, const Vec3d& flux) {
    const Patch& patch = scene_.patches[j];
    const Vec3d added = flux / patch.area;
    const Vec3d reflected = added * Vec3d(patch.reflectance);
    irradiance[j] += added;
    group.unshot[j] += reflected;
    power_[j] += channel_sum(reflected) * patch.area / group.emitted;
  }

  std::vector<Shot> most_unshot();
  double unshot_norm(const Group& group) const;
  double residual() const;

  const PatchSet& scene_;
  const SolveConfig& config_;
  RayFormFactors form_factors_;
  std::vector<Group> groups_;
  std::vector<double> power_;        ///< Unshot power of each patch, over what its groups emit.
  std::vector<std::uint64_t> cast_;  ///< Rays that each patch has cast.
  std::int64_t shots_ = 0;
  std::int64_t rays_ = 0;
};

void Refinement::shoot_emitters(Progress& progress) {
  std::vector<Shot> shots;
  for (std::size_t i = 0; i < scene_.patches.size(); ++i) {
    const Patch& patch = scene_.patches[i];
    const Group* group = group_of(patch);
    if (!group) continue;
    const double share = patch.area * channel_sum(Vec3d(patch.emission)) / group->emitted;
    shots.push_back(make_shot(std::int32_t(i), share / double(groups_.size())));
  }
  cast(shots, [&](const Shot& shot, std::span<const std::int32_t> ends) {
    const Patch& patch = scene_.patches[shot.patch];
    Group& group = *group_of(patch);
    const Vec3d flux = Vec3d(patch.emission) * (patch.area / shot.rays);
    for (const std::int32_t j : ends)
      if (j >= 0) receive(group, group.direct, j, flux);
    progress.update(0.0, "direct light");
  });
  for (Group& group : groups_) group.source_norm = unshot_norm(group);
}

void Refinement::shoot_reflections(Progress& progress) {
  const double first = residual();
  const std::int64_t most_shots = config_.max_shots * std::int64_t(scene_.patches.size());
  double left = first;
  while (left > config_.tolerance && shots_ < most_shots) {
    const std::vector<Shot> shots = most_unshot();
    cast(shots, [&](const Shot& shot, std::span<const std::int32_t> ends) {
      power_[shot.patch] = 0;
      for (Group& group : groups_) {
        const Vec3d flux = group.unshot[shot.patch] * (scene_.patches[shot.patch].area / shot.rays);
        group.unshot[shot.patch] = Vec3d(0.0);
        if (flux == Vec3d(0.0)) continue;
        for (const std::int32_t j : ends)
          if (j >= 0) receive(group, group.indirect, j, flux);
      }
    });
    left = residual();
    progress.update(std::log(first / std::max(left, 1e-300)) / std::log(first / config_.tolerance),
                    fmt::format("unshot {:.2g}, {} shots", left, shots_));
  }
  if (left > config_.tolerance)
    progress.warning(
        fmt::format("stopped after {} shots at a residual of {:.2g}: raise solve.max_shots ({}) or "
                    "solve.tolerance ({})",
                    shots_, left, config_.max_shots, config_.tolerance));
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

double Refinement::unshot_norm(const Group& group) const {
  double sum = 0;
  for (std::size_t i = 0; i < scene_.patches.size(); ++i) sum += scene_.patches[i].area * group.unshot[i].length2();
  return std::sqrt(sum);
}

double Refinement::residual() const {
  double largest = 0;
  for (const Group& group : groups_)
    if (group.source_norm > 0) largest = std::max(largest, unshot_norm(group) / group.source_norm);
  return largest;
}

EnergyField Refinement::result() const {
  EnergyField energy;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    auto& group = energy.groups.emplace_back();
    group.name = scene_.light_groups[g];
    for (const Vec3d& h : groups_[g].direct) group.direct.emplace_back(Vec3f(h));
    for (const Vec3d& h : groups_[g].indirect) group.indirect.emplace_back(Vec3f(h));
  }
  energy.iterations = shots_;
  energy.rays = rays_;
  energy.residual = residual();
  return energy;
}

}  // namespace

EnergyField progressive_refinement(const PatchSet& scene, const SolveConfig& config, Progress& progress) {
  Refinement refinement(scene, config);
  refinement.shoot_emitters(progress);
  refinement.shoot_reflections(progress);
  return refinement.result();
}

}  // namespace patchlight

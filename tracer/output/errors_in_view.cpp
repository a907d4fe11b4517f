#include "tracer/output/errors_in_view.h"

#include <fmt/format.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "pipeline/job/more_samples.h"
#include "tracer/sampling/unseen.h"

namespace patchlight {

namespace {

constexpr int kRaysUp = 48;              // over the height of a view
constexpr std::size_t kMinPatches = 16;  // that must be in view: of fewer, standard errors are noise

}  // namespace

ErrorsInView::ErrorsInView(const PatchSet& scene, const RayScene& ray_scene, const PatchLookup& lookup,
                           const EnergyField& energy)
    : scene_(scene), ray_scene_(ray_scene), lookup_(lookup), hits_(scene.patches.size()), cameras_(scene.nodes.size()) {
  const std::vector<Color> all = radiosity(scene, energy);
  errors_.reserve(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const float reflected = (all[i] - scene.patches[i].emission).length();
    const bool counts = scene.patches[i].emission == Color(0.0f) && reflected > 0;
    errors_.push_back(counts ? energy.estimate->deviation[i].length() / reflected : -1.0f);
  }
}

void ErrorsInView::add(const Camera& camera, double aspect) {
  const int height = kRaysUp, width = std::max(1, int(std::lround(kRaysUp * aspect)));
  const CameraRays rays(camera, width, height);
  _mm_setcsr(_mm_getcsr() | 0x8040);  // Embree wants denormals flushed
  for (int first = 0; first < width * height; first += RayPacket::kSize) {
    ImagePoints points;
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const int k = std::min(first + lane, width * height - 1);
      points.x[lane] = float(k % width) + 0.5f;
      points.y[lane] = float(k / width) + 0.5f;
    }
    RayPacket packet;
    rays.generate(points, ray_scene_, packet);
    ray_scene_.intersect(packet, true);
    for (int lane = 0; lane < std::min(RayPacket::kSize, width * height - first); ++lane) {
      const SurfaceHit hit = ray_scene_.hit(packet, lane);
      if (!hit.front || is_unseen(scene_, hit.primitive)) continue;
      const std::int32_t patch = lookup_.patch(hit.primitive, hit.u, hit.v);
      if (errors_[patch] < 0) continue;
      ++hits_[patch];
      std::string& name = cameras_[scene_.primitives[hit.primitive].node];
      if (name.empty()) name = camera.name;
    }
  }
}

std::string ErrorsInView::warning(const SolveConfig& config) const {
  // Large primitives count by themselves, the small ones of a node together.
  const std::size_t primitives = scene_.primitives.size();
  std::vector<std::uint32_t> patches(primitives);
  for (const Patch& patch : scene_.patches) ++patches[patch.primitive];
  std::vector<std::vector<std::pair<double, double>>> seen(primitives + scene_.nodes.size());  // errors and rays
  const auto node_of = [&](std::size_t p) { return std::size_t(scene_.primitives[p].node); };
  for (std::size_t i = 0; i < hits_.size(); ++i) {
    const auto p = std::size_t(scene_.patches[i].primitive);
    if (hits_[i] > 0)
      seen[patches[p] < kMinPatches ? primitives + node_of(p) : p].emplace_back(double(errors_[i]), double(hits_[i]));
  }
  double worst = kMaxError;
  std::size_t node = 0;
  std::set<std::size_t> nodes;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (seen[k].size() < kMinPatches) continue;
    const double error = weighted_percentile(std::move(seen[k]), 1 - kMaxPart);
    if (error <= kMaxError) continue;
    const std::size_t of = k < primitives ? node_of(k) : k - primitives;
    nodes.insert(of);
    if (error <= worst) continue;
    worst = error;
    node = of;
  }
  if (nodes.empty()) return "";
  const std::string more = nodes.size() > 1 ? fmt::format(" (and of {} more nodes)", nodes.size() - 1) : "";
  return fmt::format("the light on a tenth of a surface that camera `{}` sees, node `{}`{}, may be {:.2g}% off: {}",
                     cameras_[node], scene_.nodes[node], more, 100 * worst, more_samples(config, worst / kMaxError));
}

}  // namespace patchlight

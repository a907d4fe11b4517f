#include "tracer/light/lamps/shading_cluster.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace patchlight {

namespace {

constexpr float kMinCosine = 0.98f;       // between the normals of a cluster
constexpr double kMaxAngularSize = 0.05;  // radius over distance from an emitter, below which the centre is enough
constexpr std::size_t kMaxPoints = 16;    // that a form factor is averaged over

void sort_by_pixel(std::vector<ShadingPoint>& points) {
  const auto by_pixel = [](const ShadingPoint& a, const ShadingPoint& b) { return a.pixel < b.pixel; };
  if (std::is_sorted(points.begin(), points.end(), by_pixel)) return;
  std::vector<std::uint32_t> counts(std::max_element(points.begin(), points.end(), by_pixel)->pixel + 1, 0);
  for (const ShadingPoint& point : points) ++counts[point.pixel];
  std::partial_sum(counts.begin(), counts.end(), counts.begin());
  std::vector<ShadingPoint> sorted(points.size());
  for (std::size_t k = points.size(); k-- > 0;) sorted[--counts[points[k].pixel]] = points[k];
  points = std::move(sorted);
}

}  // namespace

ShadingCluster::ShadingCluster(std::span<const ShadingPoint> cluster_points)
    : pixel(cluster_points[0].pixel),
      surface(cluster_points[0].surface),
      primitive(cluster_points[0].primitive),
      points(cluster_points) {
  for (const ShadingPoint& p : points) {
    center += p.position;
    normal += p.normal;
    flat = flat && p.normal == points[0].normal;
    weight += p.weight;
    weights[std::size_t(p.seen_by)] += p.weight;
    scattered = scattered || p.scattered;
  }
  center /= double(points.size());
  if (flat)
    normal = points[0].normal;
  else
    normal.normalize();
  double squared = 0;
  for (const ShadingPoint& p : points) squared = std::max(squared, (p.position - center).length2());
  radius = std::sqrt(squared);
}

double ShadingCluster::form_factor(const DirectLight& light, const Emitter& emitter) const {
  if (emitter.primitive == primitive) return 0.0;
  if (radius < kMaxAngularSize * light.distance(center)) return light.form_factor(center, normal);
  const std::size_t step = (points.size() + kMaxPoints - 1) / kMaxPoints;
  double sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < points.size(); k += step, ++count)
    sum += light.form_factor(points[k].position, points[k].normal);
  return sum / count;
}

double ShadingCluster::terminator(const DirectLight& light) const {
  const ShadingPoint& first = points[0];
  if (first.before_turn == Vec3f(0.0f)) return 1.0;
  const double turned = light.form_factor(center, first.normal) * double(first.normal ^ first.before_turn);
  const double own = light.form_factor(center, first.before_turn);
  if (own >= turned) return 1.0;
  const double g = own / turned;
  return g * (1 + g * (1 - g));
}

std::vector<ShadingCluster> shading_clusters(std::vector<ShadingPoint>& points) {
  const auto by_surface = [](const ShadingPoint& a, const ShadingPoint& b) { return a.surface < b.surface; };
  sort_by_pixel(points);
  for (auto first = points.begin(); first != points.end();) {
    const auto end = std::find_if(first, points.end(), [&](const ShadingPoint& p) { return p.pixel != first->pixel; });
    if (!std::is_sorted(first, end, by_surface)) std::stable_sort(first, end, by_surface);
    first = end;
  }
  std::vector<ShadingCluster> clusters;
  for (std::size_t first = 0, k = 1; k <= points.size(); ++k) {
    if (k < points.size() && points[k].pixel == points[first].pixel && points[k].surface == points[first].surface &&
        (points[k].normal ^ points[first].normal) > kMinCosine)
      continue;
    clusters.emplace_back(std::span(points).subspan(first, k - first));
    first = k;
  }
  return clusters;
}

}  // namespace patchlight

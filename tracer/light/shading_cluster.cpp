#include "tracer/light/shading_cluster.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace patchlight {

namespace {

constexpr float kAlike = 0.98f;  // cosine between the normals of a spot
constexpr double kSmall = 0.05;  // radius of a spot over its distance from a lamp where its middle stands for all of it
constexpr std::size_t kEnough = 16;  // points that stand for all of a spot near a lamp

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

ShadingCluster::ShadingCluster(std::span<const ShadingPoint> all)
    : pixel(all[0].pixel), surface(all[0].surface), primitive(all[0].primitive), points(all) {
  for (const ShadingPoint& p : points) {
    middle += p.position;
    normal += p.normal;
    weight += p.weight;
    if (p.way != ShadingPoint::Way::straight) mirrored += p.weight;
    scattered = scattered || p.way == ShadingPoint::Way::scattered;
  }
  middle /= double(points.size());
  normal.normalize();
  double squared = 0;
  for (const ShadingPoint& p : points) squared = std::max(squared, (p.position - middle).length2());
  radius = std::sqrt(squared);
}

double ShadingCluster::form_factor(const PixelLight::Lamp& lamp) const {
  if (lamp.emitter.primitive == primitive) return 0.0;
  if (radius < kSmall * lamp.light.distance(middle)) return lamp.light.form_factor(middle, normal);
  const std::size_t step = (points.size() + kEnough - 1) / kEnough;
  double sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < points.size(); k += step, ++count)
    sum += lamp.light.form_factor(points[k].position, points[k].normal);
  return sum / count;
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
        (points[k].normal ^ points[first].normal) > kAlike)
      continue;
    clusters.emplace_back(std::span(points).subspan(first, k - first));
    first = k;
  }
  return clusters;
}

}  // namespace patchlight

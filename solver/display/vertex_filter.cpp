#include "solver/display/vertex_filter.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/transport/face_lookup.h"
#include "solver/linear/filter_error.h"
#include "solver/linear/parallel_rows.h"

namespace patchlight {

namespace {

constexpr int kWidths = 3;              // of filters, of 1, 2 and 4 steps
constexpr int kPoolSteps = 4;           // of neighbours over which estimates of single vertices are pooled
constexpr std::size_t kMostMeans = 32;  // of neighbours whose median counts
constexpr double kRidge = 1e-6;         // of slopes that few vertices determine
constexpr double kMostSpread = 1.5;     // of the weights' magnitudes; vertices whose plane takes more stay as they are

/// The gathering vertices around each vertex.
class Neighbours {
 public:
  explicit Neighbours(const DisplayMesh& mesh) : faces_of_(mesh.gathered) {
    std::vector<std::int32_t> found;
    for (const DisplayMesh::Face& face : mesh.faces) {
      for (const std::int32_t corner : mesh.corners_of(face)) add_gathering(mesh, corner, found);
      for (const std::int32_t middle : mesh.middles_of(face)) add_gathering(mesh, middle, found);
      add_face(found);
    }
    for (const DisplayMesh::Facet& facet : mesh.facets) {
      for (const std::int32_t corner : facet.corners)
        if (corner >= 0) add_gathering(mesh, corner, found);
      add_face(found);
    }
  }

  /// A vertex, then those with which it shares faces.
  std::vector<std::int32_t> of(std::int32_t vertex) const {
    std::vector<std::int32_t> near{vertex};
    for (const std::int32_t f : faces_of_[vertex])
      for (const std::int32_t other : faces_[f])
        if (std::find(near.begin(), near.end(), other) == near.end()) near.push_back(other);
    return near;
  }

 private:
  /// Adds the gathering vertices from which a vertex takes its irradiance.
  static void add_gathering(const DisplayMesh& mesh, std::int32_t vertex, std::vector<std::int32_t>& found) {
    const auto first_midpoint = std::int32_t(mesh.vertices.size() - mesh.midpoints.size());
    if (vertex < mesh.gathered)
      found.push_back(vertex);
    else if (vertex >= first_midpoint && vertex < std::int32_t(mesh.vertices.size()))
      for (const std::int32_t end : mesh.midpoints[vertex - first_midpoint]) add_gathering(mesh, end, found);
  }

  void add_face(std::vector<std::int32_t>& vertices) {
    for (const std::int32_t vertex : vertices) faces_of_[vertex].push_back(std::int32_t(faces_.size()));
    faces_.push_back(std::move(vertices));
    vertices.clear();
  }

  std::vector<std::vector<std::int32_t>> faces_;     ///< Vertices of faces and facets.
  std::vector<std::vector<std::int32_t>> faces_of_;  ///< [gathered].
};

/// The weights of values at `offsets`, m, in the value at the first of them of a plane fitted to all.
std::vector<float> plane_weights(std::span<const Vec2d> offsets) {
  double size = 0;
  for (const Vec2d& d : offsets) size = std::max(size, d.length());
  std::vector<float> weights(offsets.size(), 0.0f);
  weights[0] = 1.0f;
  if (size == 0) return weights;
  Eigen::Matrix3d moments = Eigen::Vector3d(0, kRidge, kRidge).asDiagonal();
  std::vector<Eigen::Vector3d> rows;
  for (const Vec2d& d : offsets) {
    const Eigen::Vector3d& row = rows.emplace_back(1, d.x / size, d.y / size);
    moments += row * row.transpose();
  }
  const Eigen::Vector3d value = moments.ldlt().solve(Eigen::Vector3d::UnitX());
  double spread = 0;
  for (const Eigen::Vector3d& row : rows) spread += std::abs(value.dot(row));
  if (spread <= kMostSpread)
    for (std::size_t k = 0; k < rows.size(); ++k) weights[k] = float(value.dot(rows[k]));
  return weights;
}

bool is_positive(const Spectrum& s) {
  return s.c[0] >= 0 && s.c[1] >= 0 && s.c[2] >= 0;
}

}  // namespace

VertexFilter::VertexFilter(const PatchSet& scene, const DisplayMesh& mesh) : starts_{0} {
  const std::vector<Patch> points = vertex_patches(scene, mesh);
  const Neighbours neighbours(mesh);
  std::vector<Vec2d> offsets;
  for (std::int32_t i = 0; i < mesh.gathered; ++i) {
    Vec3f along, across;
    orthonormal_frame(points[i].normal, along, across);
    offsets.clear();
    for (const std::int32_t other : neighbours.of(i)) {
      const Vec3d d = points[other].center - points[i].center;
      offsets.emplace_back(d ^ Vec3d(along), d ^ Vec3d(across));
      near_.push_back(other);
    }
    const std::vector<float> weights = plane_weights(offsets);
    weights_.insert(weights_.end(), weights.begin(), weights.end());
    starts_.push_back(std::uint32_t(near_.size()));
  }
}

SpectrumField VertexFilter::step(const SpectrumField& field) const {
  SpectrumField result(field.size());
  for_each_row(field.size(), [&](std::size_t i) {
    for (std::uint32_t k = starts_[i]; k < starts_[i + 1]; ++k)
      result[i] += field[near_[k]] * Spectrum(double(weights_[k]));
  });
  return result;
}

std::vector<double> VertexFilter::pooled(std::vector<double> values, const std::vector<bool>& wanted) const {
  std::vector<double> sums(values.size());
  const auto sum_rows = [&] {
    for_each_row(values.size(), [&](std::size_t i) {
      sums[i] = 0;
      for (std::uint32_t k = starts_[i]; k < starts_[i + 1]; ++k) sums[i] += values[near_[k]];
    });
  };
  sum_rows();
  for (int s = 2; s < kPoolSteps; ++s) {
    for_each_row(values.size(), [&](std::size_t i) { values[i] = sums[i] / double(starts_[i + 1] - starts_[i]); });
    sum_rows();
  }
  std::vector<double> medians(values.size(), 0.0);
  for_each_row(values.size(), [&](std::size_t i) {
    std::array<double, kMostMeans> means;
    const std::size_t count = std::min<std::size_t>(starts_[i + 1] - starts_[i] - 1, kMostMeans);
    if (!wanted[i] || count == 0) return;
    for (std::size_t k = 0; k < count; ++k) {
      const std::int32_t j = near_[starts_[i] + 1 + k];
      means[k] = (sums[j] - values[i]) / double(starts_[j + 1] - starts_[j] - 1);
    }
    std::nth_element(means.begin(), means.begin() + count / 2, means.begin() + count);
    medians[i] = means[count / 2];
  });
  return medians;
}

SpectrumField VertexFilter::apply(const SpectrumField& irradiance, const SpectrumField& deviation) const {
  const std::size_t n = irradiance.size();
  SpectrumField result = irradiance;
  std::vector<Filtered> narrow(n);
  for (std::size_t i = 0; i < n; ++i) narrow[i] = {irradiance[i], deviation[i]};
  SpectrumField once = step(irradiance), once_noise = step(deviation);  // F^k of them
  std::vector<double> increase(n);                                      // of the squared error by the wider filter
  std::vector<bool> is_open(n, true);                                   // whether a wider filter may be better
  for (int width = 0; width < kWidths; ++width) {
    SpectrumField twice = once, twice_noise = once_noise;  // F^2k
    for (int s = 0; s < 1 << width; ++s) {
      twice = step(twice);
      twice_noise = step(twice_noise);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const Filtered wide{once[i] * Spectrum(2.0) - twice[i], once_noise[i] * Spectrum(2.0) - twice_noise[i]};
      increase[i] = error_increase(narrow[i], wide);
      narrow[i] = wide;
    }
    const std::vector<double> pooled_increase = pooled(increase, is_open);
    for (std::size_t i = 0; i < n; ++i) {
      is_open[i] = is_open[i] && pooled_increase[i] < 0;
      if (is_open[i] && is_positive(narrow[i].value)) result[i] = narrow[i].value;
    }
    once = std::move(twice);
    once_noise = std::move(twice_noise);
  }
  return result;
}

}  // namespace patchlight

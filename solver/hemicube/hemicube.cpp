#include "solver/hemicube/hemicube.h"

#include <algorithm>
#include <cmath>

#include "pipeline/model/error.h"
#include "pipeline/optics/intersect/alpha_mask.h"
#include "pipeline/optics/sampling/patch_sampling.h"
#include "pipeline/optics/sampling/random.h"

namespace patchlight {

namespace {

// Several hemicubes are drawn one above the other and then read back at once: narrow images keep a tile's rows
// adjacent.
constexpr int kImageHeight = 3072;

}  // namespace

std::array<HemicubeFace, 5> hemicube_faces(const Vec3f& point, const Vec3f& normal, float angle, float size,
                                           int resolution) {
  Vec3f a, b;
  orthonormal_frame(normal, a, b);
  const Vec3f t = a * std::cos(angle) + b * std::sin(angle), s = normal % t;
  GlView view;
  view.eye = point;
  view.near = 1e-4f * size;
  view.forward = normal;
  view.right = t;
  view.up = -s;
  std::array<HemicubeFace, 5> faces;
  faces[0] = {view, 0, resolution};
  int row = resolution;
  for (std::size_t k = 1; k < 5; ++k) {
    const std::array<Vec3f, 4> sides{t, s, -t, -s};
    view.forward = sides[k - 1];
    view.up = normal;
    view.right = normal % sides[k - 1] * -1.0f;
    view.bottom = 0.0f;
    faces[k] = {view, row, resolution / 2};
    row += resolution / 2;
  }
  return faces;
}

std::vector<float> hemicube_weights(int resolution) {
  const int n = resolution;
  const double side = 2.0 / n, area = side * side;
  std::vector<double> weights;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = side * (i + 0.5) - 1, y = side * (j + 0.5) - 1, r = x * x + y * y + 1;
      weights.push_back(area / (kPi * r * r));
    }
  for (int face = 0; face < 4; ++face)
    for (int j = 0; j < n / 2; ++j)
      for (int i = 0; i < n; ++i) {
        const double y = side * (i + 0.5) - 1, z = side * (j + 0.5), r = y * y + z * z + 1;
        weights.push_back(z * area / (kPi * r * r));
      }
  double sum = 0;
  for (const double w : weights) sum += w;
  std::vector<float> normalised;
  for (const double w : weights) normalised.push_back(float(w / sum));
  return normalised;
}

HemicubeFormFactors::HemicubeFormFactors(const PatchSet& scene, int resolution, std::uint64_t seed,
                                         const VisibleDensities& densities)
    : scene_(scene),
      resolution_(resolution),
      seed_(seed),
      densities_(densities),
      renderer_(scene),
      factor_of_id_(scene.patches.size() + 1, 0.0f) {
  if (resolution % 2 != 0)
    throw Error(ExitCode::bad_config, "the number of cells is odd", "solve.hemicube_resolution",
                "use an even number: side faces are half as high as the top");
  prefix_sums_ = hemicube_weights(resolution);
  for (std::size_t i = 1; i < prefix_sums_.size(); ++i)
    if (i % std::size_t(resolution) != 0) prefix_sums_[i] += prefix_sums_[i - 1];
  run_ends_.resize(std::size_t(resolution));
  visible_ids_.resize(prefix_sums_.size() + 1);
}

std::size_t HemicubeFormFactors::batch(std::span<const Shot> shots) const {
  return std::min(shots.size(), std::size_t(std::max(1, kImageHeight / (3 * resolution_))));
}

std::vector<std::span<const FormFactor>> HemicubeFormFactors::rows(std::span<const Shot> shots) {
  const int height = 3 * resolution_;
  renderer_.begin(resolution_, height * int(shots.size()));
  for (std::size_t k = 0; k < shots.size(); ++k) draw(shots[k], height * int(k));
  const std::vector<std::uint32_t>& ids = renderer_.read();
  factors_.clear();
  std::vector<std::size_t> row_ends;
  for (std::size_t k = 0; k < shots.size(); ++k)
    row_ends.push_back(gather(ids.data() + std::size_t(height) * k * resolution_));
  std::vector<std::span<const FormFactor>> result;
  std::size_t begin = 0;
  for (const std::size_t end : row_ends) {
    result.push_back(std::span(factors_).subspan(begin, end - begin));
    begin = end;
  }
  return result;
}

void HemicubeFormFactors::draw(const Shot& shot, int bottom) {
  const Patch& patch = scene_.patches[shot.patch];
  const Primitive& primitive = scene_.primitives[patch.primitive];
  const std::uint64_t hash = hash64(seed_ ^ hash64(std::uint64_t(shot.patch)));
  SurfacePoint point{patch.center, patch.normal};
  const bool has_mask = has_alpha_mask(scene_, patch);
  if (shot.skip > 0 || has_mask) {
    const PatchSampler sampler(scene_.primitives, patch);
    Vec2f uv = kronecker2(shot.skip, hash);
    if (const VisibleDensity* density = densities_.find(shot.patch)) uv = (*density)(uv);
    if (has_mask) uv = covered_point(scene_, patch, sampler, uv, hash64(hash + shot.skip));
    point = sampler(uv.x, uv.y);
  }
  const float angle = uniform01(hash64(hash + shot.skip)) * float(kPi / 2);
  for (HemicubeFace& face : hemicube_faces(renderer_.to_local(point.position), point.normal, angle,
                                           float(std::sqrt(patch.area)), resolution_)) {
    face.view.self = patch.primitive;
    face.view.self_inside = primitive.sphere_radius < 0;
    renderer_.draw(face.view, 0, bottom + face.row, resolution_, face.rows);
  }
}

/// Appends the sums of a hemicube's cells by patch to `factors_`; returns the new size.
std::size_t HemicubeFormFactors::gather(const std::uint32_t* ids) {
  // Branch-free: branches would be mispredicted at about every other run of equal cells.
  const int n = resolution_;
  int* const last_of_run = run_ends_.data();
  std::size_t count = 0;
  for (int j = 0; j < 3 * n; ++j) {
    const std::uint32_t* id = ids + std::size_t(j) * n;
    const float* sum = prefix_sums_.data() + std::size_t(j) * n;
    int runs = 0;
    for (int i = 0; i + 1 < n; ++i) {
      last_of_run[runs] = i;
      runs += id[i] != id[i + 1];
    }
    last_of_run[runs++] = n - 1;
    float previous = 0;
    for (int k = 0; k < runs; ++k) {
      const std::uint32_t visible = id[last_of_run[k]];
      visible_ids_[count] = visible;
      count += factor_of_id_[visible] == 0;
      factor_of_id_[visible] += sum[last_of_run[k]] - previous;
      previous = sum[last_of_run[k]];
    }
  }
  for (const std::uint32_t visible : std::span(visible_ids_).first(count)) {
    if (visible > 0) factors_.push_back({std::int32_t(visible - 1), factor_of_id_[visible]});
    factor_of_id_[visible] = 0;
  }
  return factors_.size();
}

}  // namespace patchlight

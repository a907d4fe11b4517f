#include "solver/exposed_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "pipeline/optics/patch_sampling.h"
#include "pipeline/optics/random.h"
#include "solver/surroundings.h"

namespace patchlight {

namespace {

constexpr int kLeastCells = 7;  // of the lattice along either side; its inner lines are placed at random
constexpr int kMostCells = 64;
constexpr double kRaysOfLeast = 256;    // of a row, up to which these are enough
constexpr int kSteps = 5;               // of bisection between two nodes
constexpr float kInset = 0.01f;         // of a patch: how far inside its border places lie
constexpr float kCovered = 0.5f;        // of the exposure of the most exposed place, below which a place is covered
constexpr float kLeastExposed = 0.25f;  // part of a patch: the less there is, the noisier

class Lattice {
 public:
  Lattice(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch, int rays, std::uint64_t random)
      : cells_(std::clamp(int(kLeastCells * std::sqrt(rays / kRaysOfLeast)), kLeastCells, kMostCells)),
        nodes_(cells_ + 1),
        ray_scene_(ray_scene),
        sampler_(scene.primitives[patch.primitive], patch),
        offset_(ray_scene.offset(patch.primitive)),
        random_(random),
        exposed_(std::size_t(nodes_) * nodes_),
        along_x_(exposed_.size()),
        along_y_(exposed_.size()) {
    for (int axis = 0; axis < 2; ++axis) {
      const float shift = to_unit(scramble(random + std::uint64_t(axis)));
      lines_[axis].push_back(0.0f);
      for (int k = 1; k < cells_; ++k) lines_[axis].push_back((float(k - 1) + shift) / float(cells_ - 1));
      lines_[axis].push_back(1.0f);
    }
  }

  float exposed_part() {
    std::vector<Vec2f> places;
    for (int j = 0; j < nodes_; ++j)
      for (int i = 0; i < nodes_; ++i) places.emplace_back(lines_[0][i], lines_[1][j]);
    const std::vector<float> exposures = exposures_of(places);
    const float most = *std::max_element(exposures.begin(), exposures.end());
    if (most == 0) return 1.0f;
    least_ = kCovered * most;
    for (std::size_t k = 0; k < exposures.size(); ++k) exposed_[k] = exposures[k] >= least_;
    if (std::find(exposed_.begin(), exposed_.end(), false) == exposed_.end()) return 1.0f;
    find_crossings();
    float sum = 0;
    for (int j = 0; j < cells_; ++j)
      for (int i = 0; i < cells_; ++i)
        sum += part_of_cell(i, j) * (lines_[0][i + 1] - lines_[0][i]) * (lines_[1][j + 1] - lines_[1][j]);
    return std::max(kLeastExposed, sum);
  }

  std::int64_t cast() const { return cast_; }

 private:
  std::size_t node(int i, int j) const { return std::size_t(j) * nodes_ + i; }

  /// Of each place's four rays, those that end on lit surfaces; 1 if no unlit back is in sight.
  std::vector<float> exposures_of(std::span<const Vec2f> places) {
    const auto place_of = [](int lane) { return std::size_t((lane ^ lane >> 2) & 3); };  // its rays go all ways
    std::vector<float> exposures;
    for (std::size_t first = 0; first < places.size(); first += 4) {
      const StratifiedDirections directions(scramble(random_ + ++packets_));
      RayPacket packet;
      packet.clear();
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        if (first + place_of(lane) >= places.size()) continue;
        const Vec2f& at = places[first + place_of(lane)];
        const SurfacePoint point = sampler_(std::clamp(at.x, kInset, 1 - kInset), std::clamp(at.y, kInset, 1 - kInset));
        directions.set(lane, ray_scene_, point, offset_, packet);
      }
      ray_scene_.intersect(packet, false);
      std::array<int, 4> lit{}, backs{};
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const SurfaceHit hit = ray_scene_.hit(packet, lane);
        lit[place_of(lane)] += hit.front;
        backs[place_of(lane)] += !hit.front && hit.primitive >= 0;
      }
      for (std::size_t k = 0; k < std::min<std::size_t>(4, places.size() - first); ++k)
        exposures.push_back(backs[k] > 0 ? 0.25f * float(lit[k]) : 1.0f);
    }
    cast_ += 4 * std::int64_t(places.size());
    return exposures;
  }

  /// Where the border crosses the lattice's edges, by bisection of all of them at once.
  void find_crossings() {
    struct Bracket {
      float* crossing;
      Vec2f from, to;
      bool exposed;  ///< At `from`.
    };
    std::vector<Bracket> brackets;
    for (int j = 0; j < nodes_; ++j)
      for (int i = 0; i < nodes_; ++i) {
        const Vec2f here(lines_[0][i], lines_[1][j]);
        const bool exposed = exposed_[node(i, j)];
        if (i < cells_ && exposed != exposed_[node(i + 1, j)])
          brackets.push_back({&along_x_[node(i, j)], here, Vec2f(lines_[0][i + 1], here.y), exposed});
        if (j < cells_ && exposed != exposed_[node(i, j + 1)])
          brackets.push_back({&along_y_[node(i, j)], here, Vec2f(here.x, lines_[1][j + 1]), exposed});
      }
    float width = 1.0f;
    for (int step = 0; step < kSteps; ++step) {
      std::vector<Vec2f> middles;
      for (const Bracket& b : brackets) middles.push_back((b.from + b.to) * 0.5f);
      const std::vector<float> exposures = exposures_of(middles);
      width *= 0.5f;
      for (std::size_t k = 0; k < brackets.size(); ++k) {
        Bracket& b = brackets[k];
        const bool before = (exposures[k] >= least_) != b.exposed;
        (before ? b.to : b.from) = middles[k];
        if (!before) *b.crossing += width;
      }
    }
    for (const Bracket& b : brackets) *b.crossing += 0.5f * width;
  }

  float part_of_cell(int i, int j) const {
    const std::array<bool, 4> in{exposed_[node(i, j)], exposed_[node(i + 1, j)], exposed_[node(i, j + 1)],
                                 exposed_[node(i + 1, j + 1)]};
    const int count = in[0] + in[1] + in[2] + in[3];
    if (count % 4 == 0) return float(count / 4);
    const float low = along_x_[node(i, j)], high = along_x_[node(i, j + 1)];
    const float left = along_y_[node(i, j)], right = along_y_[node(i + 1, j)];
    const std::array<float, 4> corners{0.5f * low * left, 0.5f * (1 - low) * right, 0.5f * high * (1 - left),
                                       0.5f * (1 - high) * (1 - right)};
    float within = 0, without = 0;
    for (int k = 0; k < 4; ++k) (in[k] ? within : without) += corners[k];
    if (count == 1) return within;
    if (count == 3) return 1 - without;
    if (in[0] == in[3]) return 0.5f * (within + 1 - without);
    if (in[0] == in[1]) return 0.5f * (in[0] ? left + right : 2 - left - right);
    return 0.5f * (in[0] ? low + high : 2 - low - high);
  }

  const int cells_, nodes_;  ///< Along either side.
  const RayScene& ray_scene_;
  const PatchSampler sampler_;
  const float offset_;
  const std::uint64_t random_;
  std::array<std::vector<float>, 2> lines_;  ///< Along x and y.
  std::vector<bool> exposed_;                ///< Nodes.
  std::vector<float> along_x_, along_y_;     ///< Crossings between a node and the next, in [0,1].
  float least_ = 0;                          ///< Exposure of what is exposed.
  std::uint64_t packets_ = 0;
  std::int64_t cast_ = 0;
};

}  // namespace

float exposed_part(const PatchSet& scene, const RayScene& ray_scene, const Patch& patch, int rays, std::uint64_t random,
                   std::int64_t& cast) {
  Lattice lattice(scene, ray_scene, patch, rays, random);
  const float part = lattice.exposed_part();
  cast += lattice.cast();
  return part;
}

}  // namespace patchlight

#include "importers/environment/environment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/job/stage_keys.h"
#include "pipeline/model/error.h"
#include "pipeline/optics/lights/sky.h"
#include "pipeline/system/content_hash.h"
#include "pipeline/system/on_demand.h"

namespace patchlight {
namespace {

constexpr int kMostColumns = 2048;   // of texels that frames show
constexpr int kRows = 24;            // of cells, 7.5 degrees high at the horizon
constexpr int kLeastSamples = 1024;  // around, of a coarse image: cells are means over them
constexpr float kContrast = 8.0f;    // times the mean, above which light is a sun's
constexpr std::size_t kMostSuns = 16;
constexpr double kSunRadius = 4 * kPi / 180.0;  // of what makes one sun, at most

float largest(const Color& c) {
  return std::max({c.x, c.y, c.z});
}

/// A direction of the image, and what comes from about there.
struct Sample {
  Vec3d direction{0.0};
  double solid_angle = 0.0;
  Color radiance{0.0f};
  Color excess{0.0f};  ///< Of the radiance, that is a sun's.
};

/// In rows from +Y down: the image's own texels, or as many points between them as cells need.
std::vector<Sample> samples_of(const Environment& sky) {
  const auto finer = [](int size, int least) { return std::max(1, (least + size - 1) / size); };
  const int across = finer(sky.width, kLeastSamples), down = finer(sky.height, kLeastSamples / 2);
  const int columns = across * sky.width, rows = down * sky.height;
  std::vector<Sample> samples;
  samples.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int j = 0; j < rows; ++j) {
    const double solid_angle = 2 * kPi / columns * (std::cos(kPi * j / rows) - std::cos(kPi * (j + 1) / rows));
    for (int i = 0; i < columns; ++i) {
      const Vec3d direction = direction_at(sky, (i + 0.5) / across, (j + 0.5) / down);
      samples.push_back({direction, solid_angle, sky_radiance(sky, Vec3f(direction)), Color(0.0f)});
    }
  }
  return samples;
}

/// Takes the light out of samples about the brightest one that is left and makes it a sun.
Light take_sun(const Environment& sky, const std::vector<Sample*>& bright) {
  const Vec3d about = bright.front()->direction;
  Vec3d middle(0.0), strength(0.0);
  std::vector<Sample*> part;
  for (Sample* sample : bright) {
    if (sample->excess != Color(0.0f) || (sample->direction ^ about) < std::cos(kSunRadius)) continue;
    sample->excess = sample->radiance - clipped(sky, sample->radiance);
    const Vec3d light = Vec3d(sample->excess) * sample->solid_angle;
    middle += sample->direction * (light.x + light.y + light.z);
    strength += light;
    part.push_back(sample);
  }
  middle.normalize();
  double spread = 0.0, weight = 0.0;
  for (const Sample* sample : part) {
    const double light = double(largest(sample->excess)) * sample->solid_angle;
    spread += light * (sample->direction - middle).length2();
    weight += light;
  }
  Light sun;
  sun.kind = Light::Kind::sun;
  sun.direction = -middle;
  sun.strength = Color(Vec3f(strength));
  // An even disk has a mean square of half its radius'; a texel is as wide as that at least.
  sun.outer = std::max(std::sqrt(2 * spread / weight), 0.5 * kPi / sky.height);
  return sun;
}

/// Raises `sky.clip` until all that is above it is in few suns; where no suns are left, takes it away.
std::vector<Light> take_suns(Environment& sky, std::vector<Sample>& samples) {
  for (;; sky.clip *= 2) {
    std::vector<Sample*> bright;
    for (Sample& sample : samples) {
      sample.excess = Color(0.0f);
      if (largest(sample.radiance) > sky.clip) bright.push_back(&sample);
    }
    std::stable_sort(bright.begin(), bright.end(),
                     [](const Sample* a, const Sample* b) { return largest(a->radiance) > largest(b->radiance); });
    std::vector<Light> suns;
    while (!bright.empty() && suns.size() < kMostSuns) {
      suns.push_back(take_sun(sky, bright));
      std::erase_if(bright, [](const Sample* sample) { return sample->excess != Color(0.0f); });
    }
    if (!bright.empty()) continue;
    if (suns.empty()) sky.clip = 0.0f;
    return suns;
  }
}

void read_image(const Job& job, Environment& sky, PatchSet& scene) {
  const std::filesystem::path& file = job.environment.image;
  const std::string place = job.file.string() + ", environment.image";
  std::error_code fault;
  if (!std::filesystem::exists(file, fault))
    throw Error(ExitCode::missing_input, fmt::format("there is no file '{}'", file.string()), place, "check the path");
  if (!std::filesystem::is_regular_file(file, fault))
    throw Error(ExitCode::bad_data, fmt::format("'{}' is not a file", file.string()), place, "name a regular file");
  static auto* const decode = on_demand<decltype(decode_environment)>("patchlight-textures", "decode_environment");
  scene.sources.push_back({path_beside_scene(file, job), hash_file(file)});
  decode(file, file.string(), kMostColumns, sky);
}

std::int32_t group_number(const std::string& name, std::vector<std::string>& groups) {
  const auto found = std::find(groups.begin(), groups.end(), name);
  const auto number = static_cast<std::int32_t>(found - groups.begin());
  if (found == groups.end()) groups.push_back(name);
  return number;
}

}  // namespace

void add_environment(const Job& job, PatchSet& scene, Progress& progress) {
  const EnvironmentConfig& config = job.environment;
  if (!config.is_set()) return;
  Environment sky;
  if (config.image.empty())
    sky.texels.assign(1, Color(1.0f));
  else
    read_image(job, sky, scene);
  const Color factor = config.color.value_or(Color(1.0f)) * static_cast<float>(config.strength);
  for (Color& texel : sky.texels) {
    texel *= factor;
    if (!std::isfinite(texel.x + texel.y + texel.z))
      throw Error(ExitCode::bad_data, "the environment is too strong for single precision", job.file.string(),
                  "lower environment.strength");
  }
  if (std::all_of(sky.texels.begin(), sky.texels.end(), [](const Color& c) { return c == Color(0.0f); })) {
    progress.warning("the environment is black, and left out");
    return;
  }
  sky.turn = config.rotation / 360.0;
  sky.light_group = group_number(config.light_group, scene.light_groups);
  if (sky.texels.size() == 1) {
    sky.cells = sky.texels;
    scene.environment = std::move(sky);
    return;
  }

  sky.rows = kRows;
  std::vector<Sample> samples = samples_of(sky);
  double mean = 0.0;
  for (const Sample& sample : samples) mean += double(largest(sample.radiance)) * sample.solid_angle / (4 * kPi);
  sky.clip = kContrast * static_cast<float>(mean);
  std::vector<Light> suns = take_suns(sky, samples);
  for (std::size_t k = 0; k < suns.size(); ++k) {
    suns[k].name = fmt::format("{} sun {}", config.light_group, k + 1);
    suns[k].light_group = sky.light_group;
    scene.lights.push_back(std::move(suns[k]));
  }
  std::vector<Vec3d> sums(2 * kRows * kRows, Vec3d(0.0));
  std::vector<double> solid_angles(sums.size());
  for (const Sample& sample : samples) {
    const auto cell = static_cast<std::size_t>(sky_cell(sky, Vec3f(sample.direction)));
    sums[cell] += Vec3d(sample.radiance - sample.excess) * sample.solid_angle;
    solid_angles[cell] += sample.solid_angle;
  }
  for (std::size_t k = 0; k < sums.size(); ++k) sky.cells.emplace_back(Vec3f(sums[k] / solid_angles[k]));
  scene.environment = std::move(sky);
}

}  // namespace patchlight

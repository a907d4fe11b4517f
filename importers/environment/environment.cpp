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

constexpr int kMaxColumns = 2048;        // texels; frames show the image at this resolution
constexpr int kRows = 24;                // of cells, 7.5 degrees high at the horizon
constexpr int kMinSamplesAcross = 1024;  // cells are means over samples; a coarse image is sampled between its texels
constexpr float kContrast = 8.0f;        // radiance / mean above which light belongs to a sun
constexpr std::size_t kMaxSuns = 16;
constexpr double kMaxSunRadius = 4 * kPi / 180.0;  // rad

float largest(const Color& c) {
  return std::max({c.x, c.y, c.z});
}

/// A direction of the image with its solid angle and radiance.
struct Sample {
  Vec3d direction{0.0};
  double solid_angle = 0.0;
  Color radiance{0.0f};
  Color excess{0.0f};  ///< Part of the radiance that belongs to a sun.
};

/// Samples in rows from +Y down: one per texel, or several if the image is too coarse for the cells.
std::vector<Sample> samples_of(const Environment& sky) {
  const auto per_texel = [](int size, int min_samples) { return std::max(1, (min_samples + size - 1) / size); };
  const int across = per_texel(sky.width, kMinSamplesAcross), down = per_texel(sky.height, kMinSamplesAcross / 2);
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

/// Moves the excess radiance of the samples around the first, brightest one into a sun. `bright`: by falling radiance.
Light extract_sun(const Environment& sky, const std::vector<Sample*>& bright) {
  const Vec3d brightest = bright.front()->direction;
  Vec3d center(0.0), strength(0.0);
  std::vector<Sample*> cluster;
  for (Sample* sample : bright) {
    if (sample->excess != Color(0.0f) || (sample->direction ^ brightest) < std::cos(kMaxSunRadius)) continue;
    sample->excess = sample->radiance - clipped(sky, sample->radiance);
    const Vec3d light = Vec3d(sample->excess) * sample->solid_angle;
    center += sample->direction * (light.x + light.y + light.z);
    strength += light;
    cluster.push_back(sample);
  }
  center.normalize();
  double spread = 0.0, weight = 0.0;
  for (const Sample* sample : cluster) {
    const double light = double(largest(sample->excess)) * sample->solid_angle;
    spread += light * (sample->direction - center).length2();
    weight += light;
  }
  Light sun;
  sun.kind = Light::Kind::sun;
  sun.direction = -center;
  sun.strength = Color(Vec3f(strength));
  // The mean squared distance in a uniform disk is half the squared radius. A sun is at least one texel wide.
  sun.outer = std::max(std::sqrt(2 * spread / weight), 0.5 * kPi / sky.height);
  return sun;
}

/// Extracts suns: doubles `sky.clip` until all radiance above it belongs to at most kMaxSuns suns. Sets it to 0 if
/// there are none.
std::vector<Light> extract_suns(Environment& sky, std::vector<Sample>& samples) {
  for (;; sky.clip *= 2) {
    std::vector<Sample*> bright;
    for (Sample& sample : samples) {
      sample.excess = Color(0.0f);
      if (largest(sample.radiance) > sky.clip) bright.push_back(&sample);
    }
    std::stable_sort(bright.begin(), bright.end(),
                     [](const Sample* a, const Sample* b) { return largest(a->radiance) > largest(b->radiance); });
    std::vector<Light> suns;
    while (!bright.empty() && suns.size() < kMaxSuns) {
      suns.push_back(extract_sun(sky, bright));
      std::erase_if(bright, [](const Sample* sample) { return sample->excess != Color(0.0f); });
    }
    if (!bright.empty()) continue;
    if (suns.empty()) sky.clip = 0.0f;
    return suns;
  }
}

void read_image(const Job& job, Environment& sky, PatchSet& scene, Progress& progress) {
  const std::filesystem::path& file = job.environment.image;
  const std::string place = job.file.string() + ", environment.image";
  std::error_code fault;
  if (!std::filesystem::exists(file, fault))
    throw Error(ExitCode::missing_input, fmt::format("there is no file '{}'", file.string()), place, "check the path");
  if (!std::filesystem::is_regular_file(file, fault))
    throw Error(ExitCode::bad_data, fmt::format("'{}' is not a regular file", file.string()), place,
                "set it to the path of an image");
  static auto* const decode = on_demand<decltype(decode_environment)>("patchlight-textures", "decode_environment");
  scene.sources.push_back({path_beside_scene(file, job), hash_file(file)});
  std::int64_t negative_texels = 0;
  decode(file, file.string(), kMaxColumns, sky, negative_texels);
  if (negative_texels > 0)
    progress.warning(fmt::format("{} texels of the environment's image '{}' have negative radiance, which counts as 0",
                                 negative_texels, file.string()));
}

/// Index of a light group, added if it is new.
std::int32_t light_group_index(const std::string& name, std::vector<std::string>& groups) {
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
    read_image(job, sky, scene, progress);
  const Color factor = config.color.value_or(Color(1.0f)) * static_cast<float>(config.strength);
  for (Color& texel : sky.texels) {
    texel *= factor;
    if (!std::isfinite(texel.x + texel.y + texel.z))
      throw Error(ExitCode::bad_data, "the environment is too strong for single precision", job.file.string(),
                  "lower environment.strength or environment.color");
  }
  if (std::all_of(sky.texels.begin(), sky.texels.end(), [](const Color& c) { return c == Color(0.0f); })) {
    progress.warning("the environment is black and is ignored");
    return;
  }
  sky.turn = config.rotation / 360.0;
  sky.light_group = light_group_index(config.light_group, scene.light_groups);
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
  std::vector<Light> suns = extract_suns(sky, samples);
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

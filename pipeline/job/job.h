#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/model/math.h"
#include "pipeline/model/shader.h"

namespace patchlight {

/// Replaces what the scene says of every material, or of the material on every node, whose name matches.
struct MaterialOverride {
  std::string pattern;  ///< Glob (fnmatch).
  std::optional<Color> reflectance{};
  std::optional<Color> emission{};           ///< Radiant exitance, W/m2.
  std::optional<Color> mirror{};             ///< Reflectance of a perfect mirror on the material.
  std::optional<std::string> light_group{};  ///< As files name it.
  std::optional<double> patch_area{};        ///< m2
  std::optional<bool> exclude{};             ///< Whether it is left out of the scene.
};

struct ImportConfig {
  std::optional<double> patch_area;  ///< m2; absent: chosen from the scene's area.
  std::int64_t max_patches = 5'000'000;
  std::optional<double> time;              ///< s, in the file's animations; absent: nodes stand in their rest state.
  std::string punctual_units = "blender";  ///< Of KHR_lights_punctual: blender, si or raw.
};

/// Light from all around; by a colour or an image.
struct EnvironmentConfig {
  std::optional<Color> color{};             ///< Radiance, W/m2/sr.
  std::filesystem::path image;              ///< Equirectangular; empty: none.
  double strength = 1.0;                    ///< What either is multiplied by.
  double rotation = 0.0;                    ///< Degrees about the vertical axis, counter-clockwise from above.
  std::string light_group = "environment";  ///< As files name it.

  bool is_set() const { return color.has_value() || !image.empty(); }
};

struct SolveConfig {
  std::string method = "matrix";
  std::string form_factors = "rays";
  int rays = 256;
  bool display = true;
  int hemicube_resolution = 128;
  double tolerance = 1e-3;
  double error_target = 0.0;      ///< Relative; 0: none.
  std::int64_t max_shots = 1000;  ///< For each patch, on average.
  std::int64_t seed = 1;
  std::uint64_t memory = 0;  ///< Most bytes, from the command line; 0: what the machine has.
};

/// What the layers of light groups are called before the group's name: as Blender calls them.
inline constexpr const char* kLightGroupLayer = "Combined_";

/// How frames show one light group.
struct LightSetting {
  double scale = 1.0;
  Color color{1.0f};
};

/// A camera of the job's own.
struct CameraConfig {
  Vec3d look_from{0.0};  ///< m, as are all here; world space, glTF axes (Y up).
  Vec3d look_at{0.0};
  Vec3d up{0.0, 1.0, 0.0};
  std::optional<double> angle;   ///< Vertical, in degrees; absent: 40.
  std::optional<double> height;  ///< Of what it sees in parallel projection.
  double turntable = 0.0;        ///< Frames in which it turns once about `look_at`, right-handed about `up`; 0: still.
};

/// OpenEXR's compressions in its order, by the names that OpenImageIO has for them.
inline constexpr std::array<const char*, 10> kExrCompressions{"none",  "rle", "zips", "zip",  "piz",
                                                              "pxr24", "b44", "b44a", "dwaa", "dwab"};

struct TraceConfig {
  std::vector<std::string> cameras;  ///< Empty: all.
  std::string frames = "1";          ///< As frame_numbers() reads them.
  double fps = 24.0;
  std::array<int, 2> resolution{640, 480};
  int samples = 16;
  std::string quality = "direct";  ///< patches, direct or gather.
  int gather_rays = 64;            ///< Of a sample, with quality gather.
  bool cull_backfaces = false;
  std::vector<std::string> layers;  ///< Of the EXR, beside the beauty; `light_groups` stands for one for each.
  std::string pixel_type = "half";  ///< half or float, of the EXR's light and colours.
  std::string compression = "zip";  ///< Of the EXR, as OpenImageIO names it.
  std::string view = "sRGB";
  double exposure = 0.0;  ///< Stops, for the PNG alone.

  bool asks_for(std::string_view layer) const { return std::find(layers.begin(), layers.end(), layer) != layers.end(); }
};

/// One axis of a job's matrix: what it can be, each by a name and overrides.
struct MatrixAxis {
  struct Choice {
    std::string name;
    std::vector<std::pair<std::string, std::string>> settings;  ///< Key and value, as an override takes them.
  };
  std::string name;
  std::vector<Choice> choices;
};

/// One key of the job and the values to try, each as an override takes it.
struct SweepAxis {
  std::string key;  ///< Dotted, as in an override.
  std::vector<std::string> values;
};

/// Every combination of the axes' values.
using SweepGrid = std::vector<SweepAxis>;

/// What `patchlight bench` runs; no stage reads it, and no key of theirs depends on it.
struct BenchConfig {
  std::vector<SweepGrid> sweep;
  std::filesystem::path reference;  ///< EXR; empty: none.
  std::optional<Color> radiance;    ///< Of every pixel of the reference, W/m2/sr.
  std::map<std::string, std::string> reference_settings{
      {"solve.rays", "16384"}, {"solve.tolerance", "1e-5"}, {"trace.samples", "64"}};  ///< Where neither is given.
  std::string camera;                                                                  ///< Empty: the first.
  int repeats = 1;
};

/// How `executor: slurm` has stages run; no stage reads it.
struct SlurmConfig {
  int shards = 8;                    ///< Tasks that rows, and frames, are shared by.
  int cpus = 1;                      ///< Of a task.
  std::string partition;             ///< Empty: as Slurm has it.
  std::string time;                  ///< Most that a task may take, as sbatch takes it; empty: as Slurm has it.
  std::vector<std::string> options;  ///< More for sbatch.
  int retries = 2;                   ///< Of a task that is lost or killed.
};

/// A job file with its overrides applied and checked.
struct Job {
  std::filesystem::path file;
  std::filesystem::path scene;
  std::filesystem::path output;
  ImportConfig import;
  std::vector<MaterialOverride> materials;
  std::vector<MaterialOverride> nodes;  ///< Applied after those of materials.
  std::vector<Shader> shaders;
  EnvironmentConfig environment;
  SolveConfig solve;
  std::map<std::string, LightSetting> lights;   ///< By light group, as files name it.
  std::map<std::string, CameraConfig> cameras;  ///< By name.
  TraceConfig trace;
  BenchConfig bench;
  std::vector<MatrixAxis> matrix;  ///< Every combination is a variant for the driver to run; no stage reads it.
  std::string executor = "local";  ///< local or slurm: where the driver has stages run.
  SlurmConfig slurm;
  std::uint64_t cache = std::uint64_t(10) << 30;  ///< Most bytes of outputs of earlier settings to keep.

  std::filesystem::path patch_file() const { return output / "patches.h5"; }
  std::filesystem::path transport_file() const { return output / "transport.h5"; }
  std::filesystem::path energy_file() const { return output / "energy.h5"; }
  std::filesystem::path frame_folder() const { return output / "frames"; }
  std::filesystem::path relit_folder() const { return output / "relit"; }
};

}  // namespace patchlight

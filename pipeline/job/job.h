#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/model/math.h"
#include "pipeline/model/shader.h"

namespace patchlight {

/// Overrides properties of materials, or of the materials on nodes, whose name matches a pattern.
struct MaterialOverride {
  std::string pattern;  ///< Glob (fnmatch).
  std::optional<Color> reflectance{};
  std::optional<Color> emission{};           ///< Radiant exitance, W/m2.
  std::optional<Color> mirror{};             ///< Perfect specular reflectance.
  std::optional<double> specular{};          ///< Strength of the coat, in [0,1]; 0: no coat.
  std::optional<double> roughness{};         ///< Of coat and metal, in [0,1].
  std::optional<double> ior{};               ///< Index of refraction of the coat, at least 1.
  std::optional<std::string> light_group{};  ///< As in files (light_group_name).
  std::optional<double> patch_area{};        ///< m2
  std::optional<bool> exclude{};             ///< Whether it is excluded from the scene.
};

struct ImportConfig {
  std::optional<double> patch_area{};  ///< m2; absent: chosen by `accuracy` and the sizes of surfaces.
  double accuracy = 1.0;               ///< Number of patches, over that of the default.
  std::int64_t max_patches = 5'000'000;
  std::optional<double> time;              ///< s, of the file's animations; absent: rest pose.
  std::string punctual_units = "blender";  ///< Of KHR_lights_punctual: blender, si or raw.
  bool dielectric_coat = true;             ///< Whether surfaces have the coats of their materials.
};

/// Light from all directions, of a colour or an image.
struct EnvironmentConfig {
  std::optional<Color> color{};             ///< Radiance, W/m2/sr.
  std::filesystem::path image;              ///< Equirectangular; empty: none.
  double strength = 1.0;                    ///< Factor of the colour or image.
  double rotation = 0.0;                    ///< Degrees about the vertical axis, counter-clockwise from above.
  std::string light_group = "environment";  ///< As in files.

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
  std::int64_t max_shots = 1000;  ///< Per patch, on average.
  std::int64_t seed = 1;
  std::uint64_t memory = 0;  ///< Limit in bytes, from the command line; 0: the machine's memory.
};

/// Prefix of the layers of light groups, as in Blender.
inline constexpr const char* kLightGroupLayer = "Combined_";

/// A value that may change from frame to frame.
template <class Value>
struct ByFrame {
  Value constant;               ///< Without keys.
  std::map<int, Value> keys{};  ///< By frame.

  ByFrame(const Value& value) : constant(value) {}
  friend bool operator==(const ByFrame&, const ByFrame&) = default;

  /// Linear between keys, constant before the first and after the last.
  Value at(int frame) const {
    if (keys.empty()) return constant;
    const auto next = keys.upper_bound(frame);
    if (next == keys.begin()) return next->second;
    const auto last = std::prev(next);
    if (next == keys.end()) return last->second;
    const float part = float(frame - last->first) / float(next->first - last->first);
    return last->second * (1 - part) + next->second * part;
  }
};

/// Settings of one light group: how frames show it, and the size and distribution of its lights without a surface.
struct LightSetting {
  ByFrame<double> scale = 1.0;
  ByFrame<Color> color = Color(1.0f);
  std::optional<double> radius{};  ///< Of point lights and spots, m; absent: the scene's.
  std::optional<double> angle{};   ///< Apparent diameter of suns, degrees; absent: the scene's.
  std::filesystem::path ies{};     ///< Photometric file of point lights and spots; empty: the scene's.

  bool is_animated() const { return !scale.keys.empty() || !color.keys.empty(); }
};

/// A camera defined by the job, or changes to a camera of the scene.
struct CameraConfig {
  std::optional<Vec3d> look_from{};  ///< m, like all lengths here; world space, glTF axes (Y up).
  std::optional<Vec3d> look_at{};
  std::optional<Vec3d> up{};     ///< Absent: +Y.
  std::optional<double> angle;   ///< Vertical, in degrees; absent: 40.
  std::optional<double> height;  ///< Of the visible region, for parallel projection.
  double turntable = 0.0;        ///< Frames per revolution about `look_at`, right-handed about `up`; 0: static.
  std::optional<Vec2d> shift{};  ///< The lens, as in Camera.
  std::optional<double> aspect{}, znear{}, zfar{}, aperture{}, focus{};

  /// Whether it is a camera by itself. Otherwise it changes the lens of the scene's camera of its name.
  bool has_pose() const { return look_from || look_at; }
};

/// OpenImageIO's names of OpenEXR's compressions, in OpenEXR's order.
inline constexpr std::array<const char*, 10> kExrCompressions{"none",  "rle", "zips", "zip",  "piz",
                                                              "pxr24", "b44", "b44a", "dwaa", "dwab"};

/// How the PNG of a frame shows its radiance.
struct PictureConfig {
  std::filesystem::path ocio;  ///< Config of OpenColorIO; empty: that of $OCIO, or the shipped one.
  std::string view = "sRGB";
  std::string look;       ///< Empty: none.
  double exposure = 0.0;  ///< Stops.
  double gamma = 1.0;     ///< Display values are raised to its inverse.
};

struct TraceConfig {
  std::vector<std::string> cameras;  ///< Empty: all.
  std::string frames = "1";          ///< For frame_numbers().
  double fps = 24.0;
  std::optional<std::array<int, 2>> resolution{};  ///< Absent: of the camera's shape; see frame_size().
  int samples = 16;
  std::string quality = "direct";  ///< patches, direct or gather.
  int gather_rays = 64;            ///< Per sample, with quality gather.
  bool cull_backfaces = false;
  std::vector<std::string> layers;  ///< Of the EXR, besides beauty; `light_groups`: one per light group.
  std::string pixel_type = "half";  ///< half or float, of the EXR's radiance and colour layers.
  std::string compression = "zip";  ///< Of the EXR, by OpenImageIO's name.
  PictureConfig picture;

  bool asks_for(std::string_view layer) const { return std::find(layers.begin(), layers.end(), layer) != layers.end(); }
};

/// One axis of a job's matrix: named values, each a set of overrides.
struct MatrixAxis {
  struct Choice {
    std::string name;
    std::vector<std::pair<std::string, std::string>> settings;  ///< Key and value of overrides.
  };
  std::string name;
  std::vector<Choice> choices;
};

/// One key of the job and the values to try, in the notation of overrides.
struct SweepAxis {
  std::string key;  ///< Dotted, as in an override.
  std::vector<std::string> values;
};

/// Every combination of the axes' values.
using SweepGrid = std::vector<SweepAxis>;

/// Settings of `patchlight bench`; stages and their keys do not depend on them.
struct BenchConfig {
  std::vector<SweepGrid> sweep;
  std::filesystem::path reference;  ///< EXR; empty: none.
  std::optional<Color> radiance;    ///< Exact radiance of all pixels, W/m2/sr.
  std::map<std::string, std::string> reference_settings{
      {"solve.rays", "16384"},
      {"solve.tolerance", "1e-5"},
      {"trace.samples", "64"}};  ///< Settings of the reference render, if neither is given.
  std::string camera;            ///< Empty: the first.
  int repeats = 1;
};

/// Settings of `executor: slurm`; stages do not read them.
struct SlurmConfig {
  int shards = 8;                    ///< Tasks among which rows and frames are divided.
  int cpus = 1;                      ///< Per task.
  std::string partition;             ///< Empty: Slurm's default.
  std::string time;                  ///< Time limit of a task, in sbatch's notation; empty: Slurm's default.
  std::vector<std::string> options;  ///< Further options for sbatch.
  int retries = 2;                   ///< Of a task that was lost or killed.
};

/// A job file with its overrides applied and checked.
struct Job {
  std::filesystem::path file;
  std::filesystem::path scene;               ///< glTF; of a Blender file, its export.
  std::vector<std::string> export_warnings;  ///< Of the export of a Blender file.
  std::filesystem::path output;
  ImportConfig import;
  std::vector<MaterialOverride> materials;
  std::vector<MaterialOverride> nodes;  ///< Applied after those of materials.
  std::vector<Shader> shaders;
  EnvironmentConfig environment;
  SolveConfig solve;
  std::map<std::string, LightSetting> lights;   ///< By light group, as in files.
  std::map<std::string, CameraConfig> cameras;  ///< By name.
  TraceConfig trace;
  BenchConfig bench;
  std::vector<MatrixAxis> matrix;  ///< The driver runs every combination; stages do not read it.
  std::string executor = "local";  ///< Where the driver runs stages: local or slurm.
  SlurmConfig slurm;
  std::uint64_t cache = std::uint64_t(10) << 30;  ///< Limit in bytes of kept outputs of earlier settings.

  std::filesystem::path patch_file() const { return output / "patches.h5"; }
  std::filesystem::path transport_file() const { return output / "transport.h5"; }
  std::filesystem::path energy_file() const { return output / "energy.h5"; }
  std::filesystem::path frame_folder() const { return output / "frames"; }
  std::filesystem::path relit_folder() const { return output / "relit"; }

  /// The paths of files that stages read beside the scene, relative to the job's folder in job files.
  std::vector<std::filesystem::path*> input_files() {
    std::vector<std::filesystem::path*> files{&environment.image, &trace.picture.ocio};
    for (auto& [group, light] : lights) files.push_back(&light.ies);
    return files;
  }
};

}  // namespace patchlight

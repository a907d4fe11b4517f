#include "pipeline/job/schema/job_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>

#include "pipeline/job/nearest_word.h"
#include "pipeline/job/schema/camera_schema.h"
#include "pipeline/job/schema/job_override.h"
#include "pipeline/job/schema/key_kinds.h"
#include "pipeline/job/schema/shader_schema.h"
#include "pipeline/job/schema/value_parsing.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

JobKey patch_area_key(std::optional<double>& value) {
  return {"import.patch_area", "target area of a patch in m2; absent: chosen by import.accuracy",
          [&value](const Node& n) { value = parse_number(n, 1e-30, 1e30); },
          [&value] { return value ? number_node(*value) : Node(); }};
}

JobKey time_key(std::optional<double>& value) {
  return {"import.time", "time at which animated nodes are posed, in seconds; absent: their rest pose",
          [&value](const Node& n) { value = parse_number(n, 0, 1e9); },
          [&value] { return value ? Node(*value) : Node(); }};
}

std::vector<JobKey> import_keys(ImportConfig& config) {
  return {
      patch_area_key(config.patch_area),
      number_key("import.accuracy", config.accuracy, 0.01, 1000,
                 "number of patches, over that of the default, without import.patch_area"),
      integer_key("import.max_patches", config.max_patches, 1, 1'000'000'000, "more patches than this are refused"),
      time_key(config.time),
      choice_key(
          "import.punctual_units", config.punctual_units, {"blender", "si", "raw"},
          "unit of point lights, spots and suns: watts as Blender exports them; candela and lux; or W/sr and W/m2"),
      flag_key("import.dielectric_coat", config.dielectric_coat, "surfaces have the glossy coats of their materials"),
  };
}

std::vector<JobKey> scene_keys(Job& job) {
  return {
      overrides_key("materials", job.materials,
                    "by name (globs): reflectance [r,g,b]; emission [r,g,b], radiant exitance in W/m2; mirror [r,g,b], "
                    "reflectance of a perfect mirror; specular, strength of the coat; roughness; ior, of the coat; "
                    "light_group; patch_area in m2; exclude from the scene"),
      overrides_key("nodes", job.nodes, "the same overrides by node name (globs); they take precedence over materials"),
      {"shaders",
       "by material or node name (globs): reflectance and emission as expressions [r,g,b] of u, v, x, y, z, nx, ny, nz",
       [&job](const Node& n) { read_shaders(n, job.shaders); }, [&job] { return shaders_node(job.shaders); }},
  };
}

std::vector<JobKey> solve_keys(SolveConfig& solve) {
  const std::int64_t most = std::numeric_limits<std::int64_t>::max();
  return {
      choice_key("solve.method", solve.method, {"matrix", "progressive"}, "how the linear system is solved"),
      choice_key("solve.form_factors", solve.form_factors, {"rays", "hemicube"}, "how form factors are computed"),
      integer_key("solve.rays", solve.rays, 1, 1 << 24, "rays per row of form factors; with `progressive`, per shot"),
      flag_key("solve.display", solve.display, "also gather the display solution that frames interpolate"),
      integer_key("solve.hemicube_resolution", solve.hemicube_resolution, 2, 4096, "cells along a hemicube's edge"),
      number_key("solve.tolerance", solve.tolerance, 1e-12, 1, "stop when the residual is below this"),
      number_key("solve.error_target", solve.error_target, 0, 1,
                 "cast rays until the stated bound of the error is below this; 0: cast solve.rays"),
      integer_key("solve.max_shots", solve.max_shots, 1, 1'000'000'000,
                  "stop after this number of shots per patch, on average"),
      integer_key("solve.seed", solve.seed, 0, most, "seed of the random numbers"),
  };
}

JobKey cameras_key(std::map<std::string, CameraConfig>& cameras) {
  return {"cameras",
          "beside the scene's, by name: look_from, look_at, up [x,y,z]; angle, vertical in degrees, or height in m; "
          "turntable, frames for a turn; shift [x,y] of the image in widths and heights; aspect; znear, zfar, aperture "
          "and focus in m; without look_from and look_at: changes of the scene's camera",
          [&cameras](const Node& n) {
            cameras.clear();
            read_cameras(n, cameras);
          },
          [&cameras] { return cameras_node(cameras); }, [&cameras](const Node& n) { read_cameras(n, cameras); }};
}

/// The reader of job files reads this key before all others.
JobKey include_key() {
  return {"include", "job files, relative to this one, whose keys this one overrides", [](const Node&) {},
          [] { return Node(""); }};
}

}  // namespace

std::vector<JobKey> job_keys(Job& job) {
  std::vector<JobKey> keys{
      path_key("scene", job.scene, "the scene, .gltf, .glb or .blend"),
      path_key("output", job.output, "folder of all outputs"),
  };
  const auto add = [&](std::vector<JobKey> section) {
    std::move(section.begin(), section.end(), std::back_inserter(keys));
  };
  add(import_keys(job.import));
  add(scene_keys(job));
  add(environment_keys(job.environment));
  add(solve_keys(job.solve));
  keys.push_back(lights_key(job.lights));
  keys.push_back(cameras_key(job.cameras));
  add(trace_keys(job.trace));
  keys.push_back(include_key());
  keys.push_back(
      size_key("cache", job.cache, "maximum size of the cache, which keeps outputs of earlier settings; 0: no cache"));
  keys.push_back(matrix_key(job.matrix));
  keys.push_back(choice_key("executor", job.executor, {"local", "slurm"}, "where `run` runs the stages"));
  add(slurm_keys(job.slurm));
  add(bench_keys(job.bench));
  return keys;
}

std::string flow_text(const YAML::Node& value) {
  YAML::Emitter out;
  out.SetSeqFormat(YAML::Flow);
  out.SetMapFormat(YAML::Flow);
  out << value;
  return out.c_str();
}

void check_setting(const std::string& text, const YAML::Node& value, const YAML::Mark& mark) {
  thread_local Job scratch;  // a matrix may have thousands of settings
  thread_local const std::vector<JobKey> keys = job_keys(scratch);
  scratch = Job();
  const std::vector<std::string> path = split_key(text);
  for (const char* other : {"bench", "output", "matrix", "cache", "include", "executor", "slurm"})
    if (path.empty() || path[0] == other)
      throw EntryFault{"`" + text + "` cannot vary", "name a key of a stage, as in `solve.rays`", mark};
  const std::string joined = fmt::format("{}", fmt::join(path, "."));
  for (const JobKey& key : keys) {
    const bool inside = path.size() > 1 && key.path == path[0];  // a map of names
    if (key.path != joined && !inside) continue;
    YAML::Node node = value;
    for (std::size_t i = path.size(); inside && i > 1; --i) {
      YAML::Node map(YAML::NodeType::Map);
      map[path[i - 1]] = node;
      node.reset(map);
    }
    try {
      return key.read(node);
    } catch (const std::string& expected) {
      throw EntryFault{"bad value of `" + text + "`", expected, mark};
    } catch (const EntryFault& fault) {
      throw EntryFault{fault.what, fault.mend, mark};
    }
  }
  std::vector<std::string> known;
  for (const JobKey& key : keys) known.push_back(key.path);
  throw EntryFault{"unknown key `" + text + "`", "did you mean `" + nearest_word(known, joined) + "`?", mark};
}

}  // namespace patchlight

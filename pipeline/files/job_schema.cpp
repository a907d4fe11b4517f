#include "pipeline/files/job_schema.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <regex>
#include <set>

#include "pipeline/files/frame_range.h"
#include "pipeline/files/image_file.h"
#include "pipeline/files/job_cameras.h"
#include "pipeline/files/job_override.h"
#include "pipeline/files/job_shaders.h"
#include "pipeline/files/job_values.h"
#include "pipeline/files/light_group_name.h"
#include "pipeline/files/nearest_word.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

std::int64_t parse_integer(const Node& node, std::int64_t low, std::int64_t high) {
  const std::string expected = fmt::format("a whole number from {} to {}", low, high);
  const std::int64_t value = parse<std::int64_t>(node, expected);
  if (value < low || value > high) throw "expected " + expected;
  return value;
}

Color parse_color(const Node& node, double high) {
  if (!node.IsSequence() || node.size() != 3) throw std::string("expected three numbers [red, green, blue]");
  return Color(float(parse_number(node[0], 0, high)), float(parse_number(node[1], 0, high)),
               float(parse_number(node[2], 0, high)));
}

std::string parse_choice(const Node& node, const std::vector<std::string>& choices) {
  const std::string value = parse<std::string>(node, "a word");
  for (const auto& choice : choices)
    if (value == choice) return value;
  throw fmt::format("expected {}", fmt::join(choices, " or "));
}

std::string parse_group(const Node& node) {
  const std::string name = parse<std::string>(node, "the name of a light group");
  if (name.empty() || name.size() > kLongestLightGroup)
    throw fmt::format("expected a name of 1 to {} bytes", kLongestLightGroup);
  return light_group_name(name);
}

/// `section` is materials or nodes.
void read_overrides(const std::string& section, const Node& map, std::vector<MaterialOverride>& overrides) {
  read_entries(section, map, [&](const std::string& name) -> EntryReader {
    std::size_t at = 0;
    while (at < overrides.size() && overrides[at].pattern != name) ++at;
    if (at == overrides.size()) overrides.push_back({name});
    MaterialOverride& change = overrides[at];
    constexpr double kBrightest = std::numeric_limits<float>::max();
    return {{"reflectance", [&](const Node& n) { change.reflectance = parse_color(n, 1); }},
            {"emission", [&](const Node& n) { change.emission = parse_color(n, kBrightest); }},
            {"mirror", [&](const Node& n) { change.mirror = parse_color(n, 1); }},
            {"light_group", [&](const Node& n) { change.light_group = parse_group(n); }},
            {"patch_area", [&](const Node& n) { change.patch_area = parse_number(n, 1e-30, 1e30); }},
            {"exclude", [&](const Node& n) { change.exclude = parse<bool>(n, "true or false"); }}};
  });
}

Node overrides_node(const std::vector<MaterialOverride>& overrides) {
  Node map(YAML::NodeType::Map);
  for (const auto& change : overrides) {
    if (change.reflectance) map[change.pattern]["reflectance"] = vector_node(*change.reflectance);
    if (change.emission) map[change.pattern]["emission"] = vector_node(*change.emission);
    if (change.mirror) map[change.pattern]["mirror"] = vector_node(*change.mirror);
    if (change.light_group) map[change.pattern]["light_group"] = *change.light_group;
    if (change.patch_area) map[change.pattern]["patch_area"] = *change.patch_area;
    if (change.exclude) map[change.pattern]["exclude"] = *change.exclude;
  }
  return map;
}

JobKey overrides_key(const std::string& section, std::vector<MaterialOverride>& overrides, const std::string& help) {
  return {section, help,
          [section, &overrides](const Node& n) {
            overrides.clear();
            read_overrides(section, n, overrides);
          },
          [&overrides] { return overrides_node(overrides); },
          [section, &overrides](const Node& n) { read_overrides(section, n, overrides); }};
}

void read_lights(const Node& map, std::map<std::string, LightSetting>& lights) {
  read_entries("lights", map, [&](const std::string& name) -> EntryReader {
    LightSetting& light = lights[light_group_name(name)];
    return {{"scale", [&](const Node& n) { light.scale = parse_number(n, 0, 1e30); }},
            {"color", [&](const Node& n) { light.color = parse_color(n, 1e30); }}};
  });
}

Node lights_node(const std::map<std::string, LightSetting>& lights) {
  Node map(YAML::NodeType::Map);
  for (const auto& [name, light] : lights) {
    map[name]["scale"] = number_node(light.scale);
    map[name]["color"] = vector_node(light.color);
  }
  return map;
}

JobKey path_key(const std::string& path, std::filesystem::path& value, const std::string& help) {
  return {path, help,
          [&value](const Node& n) {
            value = parse<std::string>(n, "a path");
            if (value.empty()) throw std::string("expected a path");
          },
          [&value] { return Node(value.string()); }};
}

JobKey number_key(const std::string& path, double& value, double low, double high, const std::string& help) {
  return {path, help, [&value, low, high](const Node& n) { value = parse_number(n, low, high); },
          [&value] { return number_node(value); }};
}

template <class Integer>
JobKey integer_key(const std::string& path, Integer& value, std::int64_t low, std::int64_t high,
                   const std::string& help) {
  return {path, help, [&value, low, high](const Node& n) { value = Integer(parse_integer(n, low, high)); },
          [&value] { return Node(value); }};
}

JobKey flag_key(const std::string& path, bool& value, const std::string& help) {
  return {path, help, [&value](const Node& n) { value = parse<bool>(n, "true or false"); },
          [&value] { return Node(value); }};
}

JobKey choice_key(const std::string& path, std::string& value, const std::vector<std::string>& choices,
                  const std::string& help) {
  return {path, help, [&value, choices](const Node& n) { value = parse_choice(n, choices); },
          [&value] { return Node(value); }};
}

JobKey patch_area_key(std::optional<double>& value) {
  return {"import.patch_area", "target area of a patch in m2; absent: 1/8000 of the scene's area",
          [&value](const Node& n) { value = parse_number(n, 1e-30, 1e30); },
          [&value] { return value ? number_node(*value) : Node(); }};
}

JobKey time_key(std::optional<double>& value) {
  return {"import.time", "when animated nodes stand where they do, in seconds; absent: in their rest state",
          [&value](const Node& n) { value = parse_number(n, 0, 1e9); },
          [&value] { return value ? Node(*value) : Node(); }};
}

JobKey cameras_key(std::vector<std::string>& cameras) {
  return {"trace.cameras", "names of cameras, those of glTF nodes or of the job's `cameras`; absent: all",
          [&cameras](const Node& n) {
            if (n.IsScalar())
              cameras = {n.as<std::string>()};
            else
              cameras = parse<std::vector<std::string>>(n, "a list of camera names");
          },
          [&cameras] { return Node(cameras); }};
}

JobKey frames_key(std::string& frames) {
  return {
      "trace.frames",
      "frames of cameras that move: 1-120; 1,5..9; with a step 1-120x10 or 1..120:10; a still one writes frame 0001",
      [&frames](const Node& n) {
        const std::string expected = "frames such as 1-120 or 1,5..9,20-40x2";
        std::string list;
        if (n.IsSequence())
          list = fmt::format("{}", fmt::join(parse<std::vector<std::string>>(n, expected), ", "));
        else
          list = parse<std::string>(n, expected);
        frame_numbers(list);
        frames = list;
      },
      [&frames] { return Node(frames); }};
}

JobKey resolution_key(std::array<int, 2>& size) {
  return {"trace.resolution", "width and height of frames in pixels",
          [&size](const Node& n) {
            if (!n.IsSequence() || n.size() != 2) throw std::string("expected [width, height]");
            for (std::size_t k = 0; k < 2; ++k) size[k] = int(parse_integer(n[k], 1, 65536));
          },
          [&size] {
            Node node;
            node.SetStyle(YAML::EmitterStyle::Flow);
            node.push_back(size[0]);
            node.push_back(size[1]);
            return node;
          }};
}

JobKey layers_key(std::vector<std::string>& layers) {
  const std::vector<std::string> known{"direct", "indirect", "specular", "emission", "albedo",
                                       "normal", "depth",    "position", "patch",    "light_groups"};
  return {"trace.layers", fmt::format("of the EXR, beside the beauty: {}", fmt::join(known, ", ")),
          [&layers, known](const Node& n) {
            if (n.IsMap()) throw std::string("expected a list of layers");
            std::set<std::string> chosen;
            if (n.IsScalar()) chosen.insert(parse_choice(n, known));
            for (const Node& name : n) chosen.insert(parse_choice(name, known));
            layers.clear();
            for (const std::string& name : known)  // their order means nothing
              if (chosen.contains(name)) layers.push_back(name);
          },
          [&layers] { return Node(layers); }};
}

JobKey view_key(std::string& view) {
  return {"trace.view", "OpenColorIO view of the PNG: sRGB, ACES or Raw of the shipped config, or one of $OCIO's",
          [&view](const Node& n) { view = parse<std::string>(n, "the name of a view"); },
          [&view] { return Node(view); }};
}

/// Read before all others, by the reader of job files.
JobKey include_key() {
  return {"include", "job files, relative to this one, whose keys this one overrides", [](const Node&) {},
          [] { return Node(""); }};
}

/// A size in bytes, as in 500MiB; units are powers of 1024.
std::uint64_t parse_size(const Node& node) {
  const std::string expected = "expected a size such as 10GiB or 500MiB, or 0";
  static const std::regex size("([0-9]{1,12}(?:\\.[0-9]{1,6})?) *(?:([KMGT])(?:i?B)?|B)?");
  std::smatch parts;
  const std::string text = node.IsScalar() ? node.Scalar() : "";
  if (!std::regex_match(text, parts, size)) throw expected;
  const std::string unit = parts[2].str();
  const auto power = unit.empty() ? 0 : 1 + std::string("KMGT").find(unit);
  const double bytes = std::stod(parts[1].str()) * std::pow(1024.0, double(power));
  if (bytes > 1e18) throw expected;
  return std::uint64_t(bytes);
}

std::string size_text(std::uint64_t bytes) {
  std::size_t power = 0;
  while (power < 4 && bytes > 0 && bytes % 1024 == 0) {
    bytes /= 1024;
    ++power;
  }
  return fmt::format("{}{}", bytes, std::array<const char*, 5>{"", "KiB", "MiB", "GiB", "TiB"}[power]);
}

JobKey cache_key(std::uint64_t& bytes) {
  return {"cache", "most that outputs of earlier settings, kept to go back to them, may take; 0: keep none",
          [&bytes](const Node& n) { bytes = parse_size(n); }, [&bytes] { return Node(size_text(bytes)); }};
}

}  // namespace

std::vector<JobKey> job_keys(Job& job) {
  const std::int64_t most = std::numeric_limits<std::int64_t>::max();
  SolveConfig& solve = job.solve;
  TraceConfig& trace = job.trace;
  std::vector<JobKey> keys{
      path_key("scene", job.scene, "the glTF scene, .gltf or .glb"),
      path_key("output", job.output, "folder for all that the job makes"),
      patch_area_key(job.import.patch_area),
      integer_key("import.max_patches", job.import.max_patches, 1, 1'000'000'000, "more patches than this are refused"),
      time_key(job.import.time),
      overrides_key("materials", job.materials,
                    "by name (globs): reflectance [r,g,b]; emission [r,g,b], radiant exitance in W/m2; mirror [r,g,b], "
                    "reflectance of a perfect mirror; light_group; patch_area in m2; exclude from the scene"),
      overrides_key("nodes", job.nodes, "the same by the name of a node (globs), after those of materials"),
      {"shaders",
       "by material or node name (globs): reflectance and emission as expressions [r,g,b] of u, v, x, y, z, nx, ny, nz",
       [&job](const Node& n) { read_shaders(n, job.shaders); }, [&job] { return shaders_node(job.shaders); }},
      choice_key("solve.method", solve.method, {"matrix", "progressive"}, "how the linear system is solved"),
      choice_key("solve.form_factors", solve.form_factors, {"rays", "hemicube"}, "how form factors are found"),
      integer_key("solve.rays", solve.rays, 1, 1 << 24,
                  "rays for each patch and each time that the light is passed on"),
      flag_key("solve.display", solve.display, "also gather the display solution that frames interpolate"),
      integer_key("solve.hemicube_resolution", solve.hemicube_resolution, 2, 4096, "cells along a hemicube's edge"),
      number_key("solve.tolerance", solve.tolerance, 1e-12, 1, "stop when the residual is below this"),
      number_key("solve.error_target", solve.error_target, 0, 1,
                 "cast rays until the stated bound of the error is below this; 0: cast solve.rays"),
      integer_key("solve.max_shots", solve.max_shots, 1, 1'000'000'000,
                  "stop after so many shots for each patch, on average"),
      integer_key("solve.seed", solve.seed, 0, most, "of the random numbers"),
      {"lights", "by light group: scale, and color [r,g,b], of its light in frames",
       [&job](const Node& n) {
         job.lights.clear();
         read_lights(n, job.lights);
       },
       [&job] { return lights_node(job.lights); }, [&job](const Node& n) { read_lights(n, job.lights); }},
      {"cameras",
       "beside the scene's, by name: look_from, look_at, up [x,y,z]; angle, vertical in degrees, or height in m; "
       "turntable, frames for a turn",
       [&job](const Node& n) {
         job.cameras.clear();
         read_cameras(n, job.cameras);
       },
       [&job] { return cameras_node(job.cameras); }, [&job](const Node& n) { read_cameras(n, job.cameras); }},
      cameras_key(trace.cameras),
      frames_key(trace.frames),
      number_key("trace.fps", trace.fps, 1e-3, 1e6, "frames a second of animated cameras"),
      resolution_key(trace.resolution),
      choice_key("trace.quality", trace.quality, {"patches", "direct", "gather"},
                 "all light interpolated; direct light at the pixel; or the rest gathered there too, to check it"),
      integer_key("trace.gather_rays", trace.gather_rays, 1, 4096, "rays of a sample by which `gather` gathers"),
      integer_key(
          "trace.samples", trace.samples, 1, 1 << 16,
          "samples of a pixel where colours change; 4 times as many at edges, a quarter (4 or more) where all is even"),
      flag_key("trace.cull_backfaces", trace.cull_backfaces, "look through the backs of single-sided surfaces"),
      layers_key(trace.layers),
      choice_key("trace.pixel_type", trace.pixel_type, {"half", "float"}, "of light and colours in the EXR"),
      choice_key("trace.compression", trace.compression, exr_compressions(), "of the EXR"),
      view_key(trace.view),
      number_key("trace.exposure", trace.exposure, -100, 100, "stops by which the PNG is brighter than the EXR"),
  };
  keys.push_back(include_key());
  keys.push_back(cache_key(job.cache));
  keys.push_back(matrix_key(job.matrix));
  for (JobKey& key : bench_keys(job.bench)) keys.push_back(std::move(key));
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
  Job scratch;
  const std::vector<JobKey> keys = job_keys(scratch);
  const std::vector<std::string> path = split_key(text);
  for (const char* other : {"bench", "output", "matrix", "cache", "include"})
    if (path.empty() || path[0] == other)
      throw EntryFault{"`" + text + "` cannot vary", "name a key of a stage, as in `solve.rays`", mark};
  const std::string joined = fmt::format("{}", fmt::join(path, "."));
  std::vector<std::string> known;
  for (const JobKey& key : keys) {
    known.push_back(key.path);
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
  throw EntryFault{"unknown key `" + text + "`", "did you mean `" + nearest_word(known, joined) + "`?", mark};
}

}  // namespace patchlight

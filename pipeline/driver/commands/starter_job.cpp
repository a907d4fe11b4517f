#include "pipeline/driver/commands/starter_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/job/frame_size.h"
#include "pipeline/job/job.h"

namespace patchlight {

namespace {

constexpr const char* kHeader =
    "## A job for `patchlight run`. As it stands it makes the frames that the scene alone makes.\n"
    "## To change a setting, take away the `# ` before it. Paths are relative to this file's folder.\n";
constexpr int kMaxFramesNamed = 10'000;

/// A name in YAML: plain if it is a simple word, else in double quotes.
std::string yaml_text(const std::string& name) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.' || c == '-' || c == '/';
  };
  const bool plain = !name.empty() && std::isalpha(static_cast<unsigned char>(name.front())) &&
                     std::all_of(name.begin(), name.end(), is_plain);
  std::string word = name;
  for (char& c : word) c = char(std::tolower(static_cast<unsigned char>(c)));
  if (plain && word != "null" && word != "true" && word != "false") return name;
  return nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// A name escaped as a glob that matches only itself.
std::string as_pattern(const std::string& name) {
  std::string pattern;
  for (const char c : name) {
    if (std::string("*?[\\").find(c) != std::string::npos) pattern += '\\';
    pattern += c;
  }
  return pattern;
}

template <class Vector>
std::string triple(const Vector& v) {
  return fmt::format("[{}, {}, {}]", v.x, v.y, v.z);
}

/// The common values of all patches whose material has one name.
struct MaterialSummary {
  std::string name;
  Color reflectance{0.0f}, emission{0.0f}, specular{0.0f};
  float roughness = 1.0f;
  bool varied_reflectance = false, varied_emission = false;
  double area = 0;       ///< m2
  Vec3d reflected{0.0};  ///< Reflectance times area.

  void add(const PatchSet& scene, const Patch& patch) {
    const Primitive& primitive = scene.primitives[patch.primitive];
    const Material& material = scene.materials[primitive.material];
    if (area == 0) {
      reflectance = patch.reflectance;
      emission = patch.emission;
      specular = material.specular;
      roughness = material.roughness;
    }
    varied_reflectance |= patch.reflectance != reflectance || material.specular != specular ||
                          material.roughness != roughness || is_colored(scene, patch.primitive);
    varied_emission |= patch.emission != emission || primitive.emission_texture >= 0;
    area += patch.area;
    reflected += Vec3d(patch.reflectance) * patch.area;
  }

  /// Whether an override that repeats the reflectance leaves the metallic part as it is.
  bool leaves_metal() const {
    for (int k = 0; k < 3; ++k)
      if (specular[k] > 1.0f - reflectance[k]) return false;
    return true;
  }

  std::string line() const {
    std::string settings, note;
    const auto add_setting = [&](const std::string& key, const Color& value) {
      settings += (settings.empty() ? "" : ", ") + key + ": " + triple(value);
    };
    if (!varied_reflectance && leaves_metal())
      add_setting("reflectance", reflectance);
    else
      note = fmt::format("  # reflectance {:.2g} {:.2g} {:.2g} on average", reflected.x / area, reflected.y / area,
                         reflected.z / area);
    if (!varied_reflectance && roughness == 0.0f && specular != Color(0.0f)) add_setting("mirror", specular);
    if (!varied_emission && emission != Color(0.0f)) add_setting("emission", emission);
    if (varied_emission) note += note.empty() ? "  # its emission varies" : ", and its emission varies";
    return fmt::format("  # {}: {{{}}}{}\n", yaml_text(as_pattern(name)), settings, note);
  }
};

std::string material_lines(const PatchSet& scene) {
  std::vector<MaterialSummary> summaries;
  std::vector<std::size_t> summary_of;  // by material
  for (const Material& material : scene.materials) {
    const auto same = [&](const MaterialSummary& summary) { return summary.name == material.name; };
    const auto found = std::find_if(summaries.begin(), summaries.end(), same);
    summary_of.push_back(std::size_t(found - summaries.begin()));
    if (found == summaries.end()) summaries.emplace_back().name = material.name;
  }
  for (const Patch& patch : scene.patches)
    summaries[summary_of[std::size_t(scene.primitives[patch.primitive].material)]].add(scene, patch);
  std::string text =
      "materials:  # reflectance; emission in W/m2; mirror, a reflectance; patch_area in m2; light_group; exclude\n";
  for (const MaterialSummary& summary : summaries)
    if (summary.area > 0) text += summary.line();
  return text;
}

std::string light_lines(const PatchSet& scene) {
  if (scene.light_groups.empty())
    return "# environment: {color: [1, 1, 1]}  # W/m2/sr from all around: the scene has no light of its own\n";
  std::string text =
      "lights:  # by light group: scale and color, in frames alone; radius in m, angle in degrees, ies of its lights\n";
  for (const std::string& group : scene.light_groups) text += fmt::format("  {}: {{scale: 1}}\n", yaml_text(group));
  return text;
}

/// The last frame at which a camera moves; 0 if all are still.
int last_frame(const PatchSet& scene, double fps) {
  double end = 0;
  for (const Camera& camera : scene.cameras)
    for (const Motion& factor : camera.motion)
      if (!factor.times.empty()) end = std::max(end, factor.times.back());
  return int(std::min(std::ceil(end * fps), double(kMaxFramesNamed)));
}

std::string trace_lines(const PatchSet& scene) {
  const TraceConfig defaults;
  std::vector<std::string> cameras;
  for (const Camera& camera : scene.cameras)
    if (const std::string name = yaml_text(camera.name);
        std::find(cameras.begin(), cameras.end(), name) == cameras.end())
      cameras.push_back(name);
  const auto [width, height] = frame_size(defaults, scene.cameras.front());
  std::string text = fmt::format("trace:\n  cameras: [{}]\n", fmt::join(cameras, ", "));
  if (const int last = last_frame(scene, defaults.fps); last > 0)
    text += fmt::format("  # frames: 1-{}  # of cameras that move, {} a second\n", last, defaults.fps);
  text += fmt::format("  # resolution: [{}, {}]  # absent: in each camera's own shape, as this is\n", width, height);
  text += fmt::format("  # samples: {}  # of a pixel\n", defaults.samples);
  return text + fmt::format("  # exposure: {}  # stops, of the PNG alone\n", defaults.picture.exposure);
}

}  // namespace

std::string starter_job(const std::string& scene_path, const std::string& output, const PatchSet& scene) {
  const SolveConfig solve;
  double area = 0;
  for (const Patch& patch : scene.patches) area += patch.area;
  const std::size_t count = scene.patches.size();
  std::string text = kHeader;
  text += fmt::format("scene: {}\noutput: {}\n", yaml_text(scene_path), yaml_text(output));
  text += fmt::format("import:\n  # patch_area: {:.3g}  # m2; absent: chosen, {} patches of this area on average\n",
                      area / double(count), count);
  text += material_lines(scene) + light_lines(scene);
  text += fmt::format("solve:\n  # rays: {}  # of a patch; more: less noise\n  # tolerance: {}\n", solve.rays,
                      solve.tolerance);
  return text + trace_lines(scene);
}

}  // namespace patchlight

#include "pipeline/job/stage_keys.h"

#include <cmath>

#include "pipeline/job/frame_size.h"
#include "pipeline/system/content_hash.h"

namespace patchlight {

namespace {

// Raised whenever a stage computes different results from the same inputs.
constexpr int kImportVersion = 21;
constexpr int kTransportKeyVersion = 45;
constexpr int kSolveVersion = 45;
constexpr int kTraceVersion = 27;

void add_color(KeyHasher& hasher, const std::optional<Color>& color) {
  hasher.add(color.has_value());
  if (color) hasher.add(double(color->x)).add(double(color->y)).add(double(color->z));
}

}  // namespace

std::string path_beside_scene(const std::filesystem::path& file, const Job& job) {
  if (file.empty()) return "";
  const auto normal = [](const std::filesystem::path& path) {
    return std::filesystem::absolute(path).lexically_normal();
  };
  return normal(file).lexically_relative(normal(job.scene).parent_path()).string();
}

std::string import_inputs_key(const std::vector<SourceFile>& sources, const Job& job) {
  KeyHasher hasher;
  hasher.add("import").add(kImportVersion);
  // The first source is the scene file. Only its content matters, not its path.
  for (std::size_t i = 0; i < sources.size(); ++i) hasher.add(i == 0 ? "" : sources[i].path).add(sources[i].hash);
  hasher.add(job.import.patch_area.value_or(0.0)).add(job.import.patch_area ? 0.0 : job.import.accuracy);
  hasher.add(job.import.time.value_or(-1.0)).add(job.import.punctual_units).add(job.import.dielectric_coat);
  for (const auto* overrides : {&job.materials, &job.nodes}) {
    hasher.add("overrides");
    for (const auto& change : *overrides) {
      hasher.add(change.pattern);
      add_color(hasher, change.reflectance);
      add_color(hasher, change.emission);
      add_color(hasher, change.mirror);
      for (const auto& value : {change.specular, change.roughness, change.ior}) hasher.add(value.value_or(-1.0));
      hasher.add(change.light_group.value_or("")).add(change.patch_area.value_or(0.0));
      hasher.add(change.exclude.value_or(false));
    }
  }
  for (const auto& [name, light] : job.lights)
    if (light.radius || light.angle || !light.ies.empty())
      hasher.add("light")
          .add(name)
          .add(light.radius.value_or(-1.0))
          .add(light.angle.value_or(-1.0))
          .add(path_beside_scene(light.ies, job));
  if (const EnvironmentConfig& sky = job.environment; sky.is_set()) {
    hasher.add("environment");
    add_color(hasher, sky.color);
    hasher.add(path_beside_scene(sky.image, job)).add(sky.strength).add(sky.rotation).add(sky.light_group);
  }
  for (const auto& shader : job.shaders) {
    hasher.add("shader").add(shader.name);
    for (const ColorExpressions* color : {&shader.reflectance, &shader.emission})
      for (const auto& expression : *color) hasher.add(expression);
  }
  return hasher.hex();
}

std::string transport_key(const std::string& geometry_key, const SolveConfig& solve) {
  return KeyHasher()
      .add("transport")
      .add(kTransportKeyVersion)
      .add(geometry_key)
      .add(solve.form_factors)
      .add(solve.form_factors == "hemicube" ? solve.hemicube_resolution : 0)
      .add(solve.rays)
      .add(solve.error_target)
      .add(solve.seed)
      .hex();
}

std::string energy_key(const std::string& patches_key, const SolveConfig& solve) {
  return KeyHasher()
      .add("solve")
      .add(kSolveVersion)
      .add(patches_key)
      .add(solve.method)
      .add(solve.form_factors)
      .add(solve.form_factors == "hemicube" ? solve.hemicube_resolution : 0)
      .add(!solve.display && solve.form_factors == "hemicube" && solve.method == "progressive" ? 0 : solve.rays)
      .add(solve.tolerance)
      .add(solve.display)
      .add(solve.error_target)
      .add(solve.method == "progressive" ? solve.max_shots : 0)
      .add(solve.seed)
      .hex();
}

std::string camera_key(const Camera& camera) {
  KeyHasher hasher;
  hasher.add("camera").add(camera.name).add(int(camera.projection)).add(camera.vertical);
  for (int k = 0; k < 16; ++k) hasher.add(camera.to_world.x[k / 4][k % 4]);
  if (camera.shift != Vec2d(0.0)) hasher.add("shift").add(camera.shift.x).add(camera.shift.y);
  if (camera.znear > 0) hasher.add("znear").add(camera.znear);
  if (std::isfinite(camera.zfar)) hasher.add("zfar").add(camera.zfar);
  if (camera.has_lens()) hasher.add("lens").add(camera.aperture).add(camera.focus);
  return hasher.hex();
}

std::string frame_key(const PatchSet& scene, const std::string& energy_key, const Job& job, const Camera& camera,
                      int frame, const std::string& view_config) {
  const TraceConfig& trace = job.trace;
  const auto [width, height] = frame_size(trace, camera);
  KeyHasher hasher;
  hasher.add("trace").add(kTraceVersion).add(scene.key).add(scene.frames_key).add(energy_key);
  hasher.add(camera_key(camera))
      .add(frame)
      .add(width)
      .add(height)
      .add(trace.samples)
      .add(trace.quality)
      .add(trace.quality == "gather" ? trace.gather_rays : 0)
      .add(view_config);
  hasher.add(trace.cull_backfaces).add(trace.picture.view).add(trace.picture.look);
  hasher.add(trace.picture.exposure).add(trace.picture.gamma);
  hasher.add(trace.pixel_type).add(trace.compression);
  for (const std::string& layer : trace.layers) hasher.add(layer);
  for (const auto& [name, light] : job.lights) {
    const double scale = light.scale.at(frame);
    const Color color = light.color.at(frame);
    if (scale == 1.0 && color == Color(1.0f)) continue;
    hasher.add(name).add(scale);
    add_color(hasher, color);
  }
  return hasher.hex();
}

std::string relit_key(const std::string& frame_key) {
  return KeyHasher().add("relight").add(frame_key).hex();
}

}  // namespace patchlight

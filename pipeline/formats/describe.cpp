#include "pipeline/formats/describe.h"

#include <ImathBox.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patchlight {

namespace {

std::string triple(const Vec3d& v) {
  return fmt::format("{:.4g} {:.4g} {:.4g}", v.x, v.y, v.z);
}

struct MaterialTotals {
  std::size_t patches = 0;
  double area = 0;
  Vec3d reflectance{0.0};  ///< Weighted by area.
  Vec3d power{0.0};        ///< W
};

std::string describe_materials(const PatchSet& scene) {
  std::vector<MaterialTotals> totals(scene.materials.size());
  for (const Patch& patch : scene.patches) {
    MaterialTotals& total = totals[scene.primitives[patch.primitive].material];
    ++total.patches;
    const double area = patch.covered_area();
    total.area += area;
    total.reflectance += Vec3d(patch.reflectance) * area;
    total.power += Vec3d(patch.emission) * area;
  }
  std::string text = "materials\n";
  for (std::size_t i = 0; i < totals.size(); ++i) {
    const MaterialTotals& total = totals[i];
    if (total.patches == 0) continue;
    text += fmt::format("  {:<24}{} patches, {:.4g} m2, reflectance {}", scene.materials[i].name, total.patches,
                        total.area, triple(total.reflectance / total.area));
    if (scene.materials[i].specular != Color(0.0f))
      text += fmt::format(", metal {} of roughness {:.2g}", triple(Vec3d(scene.materials[i].specular)),
                          scene.materials[i].roughness);
    if (scene.materials[i].coat.exists())
      text += fmt::format(", coat {} of roughness {:.2g}", triple(Vec3d(scene.materials[i].coat.normal)),
                          scene.materials[i].roughness);
    if (const ClearCoat& clear = scene.materials[i].clear_coat; clear.exists())
      text += fmt::format(", clear coat on {:.2g} of it, of roughness {:.2g}", clear.part, clear.roughness);
    if (const Transmission& glass = scene.materials[i].transmission; glass.exists())
      text += fmt::format(", {} that lets {:.2g} of the light pass, {}", glass.solid ? "body" : "sheet", glass.part,
                          triple(Vec3d(glass.tint)));
    if (const Color& passed = scene.materials[i].translucence; passed != Color(0.0f))
      text += fmt::format(", {} leaves the other side", triple(Vec3d(passed)));
    if (total.power != Vec3d(0.0)) text += fmt::format(", emits {} W", triple(total.power));
    text += "\n";
  }
  return text;
}

std::string describe_shaders(const PatchSet& scene) {
  std::string text = "shaders\n";
  for (std::size_t i = 0; i < scene.shaders.size(); ++i) {
    const Shader& shader = scene.shaders[i];
    const auto uses = std::count_if(scene.primitives.begin(), scene.primitives.end(),
                                    [&](const Primitive& p) { return p.shader == std::int32_t(i); });
    text += fmt::format("  {:<24}{} primitives", shader.name, uses);
    if (is_set(shader.reflectance)) text += fmt::format(", reflectance {}", fmt::join(shader.reflectance, ", "));
    if (is_set(shader.emission)) text += fmt::format(", emission {}", fmt::join(shader.emission, ", "));
    text += "\n";
  }
  return text;
}

double end_of_motion(const Camera& camera) {
  double end = 0;
  for (const Motion& factor : camera.motion)
    if (!factor.times.empty()) end = std::max(end, factor.times.back());
  return end;
}

std::string describe_lens(const Camera& camera) {
  std::string text;
  if (camera.shift != Vec2d(0.0)) text += fmt::format(", shift {:.4g}, {:.4g}", camera.shift.x, camera.shift.y);
  if (camera.znear > 0 || std::isfinite(camera.zfar))
    text += fmt::format(", from {:.4g} to {:.4g} m", camera.znear, camera.zfar);
  if (camera.has_lens()) text += fmt::format(", aperture {:.4g} m, sharp at {:.4g} m", camera.aperture, camera.focus);
  return text;
}

template <class Entries, class Name>
std::string describe_names(const std::string& title, const Entries& items, Name name) {
  std::string text = title + "\n";
  for (const auto& item : items) text += "  " + name(item) + "\n";
  return text;
}

}  // namespace

std::string describe(const PatchSet& scene) {
  std::size_t quads = 0, triangles = 0, spheres = 0, regions = 0, backs = 0;
  for (const Primitive& p : scene.primitives) {
    ++(p.shape == Primitive::Shape::sphere ? spheres : p.region ? regions : p.is_triangle() ? triangles : quads);
    backs += p.back >= 0;
  }
  double area = 0;
  std::size_t clusters = 0;
  std::int64_t facets = 0;
  Imath::Box3d bounds;
  for (const Patch& patch : scene.patches) {
    area += patch.covered_area();
    clusters += patch.facets > 0;
    facets += patch.facets;
    bounds.extendBy(patch.center);
  }
  std::string text = fmt::format("primitives  {} quads, {} triangles, {} spheres", quads, triangles, spheres);
  if (regions > 0) text += fmt::format(", {} planar regions", regions);
  if (backs > 0) text += fmt::format(" ({} are two-sided, counted twice)", backs / 2);
  text += fmt::format("\npatches     {}, {:.4g} m2 in all, {:.3g} m2 each", scene.patches.size(), area,
                      area / double(scene.patches.size()));
  if (clusters > 0) text += fmt::format("; {} are clusters of {} quads and triangles", clusters, facets);
  text += "\n";
  text += fmt::format("extent      {} to {} m\n", triple(bounds.min), triple(bounds.max));
  text += describe_materials(scene);
  if (!scene.shaders.empty()) text += describe_shaders(scene);
  text += describe_names("light groups", scene.light_groups, [](const std::string& name) { return name; });
  if (!scene.lights.empty())
    text += describe_names("lights", scene.lights, [&](const Light& light) {
      const bool is_sun = light.kind == Light::Kind::sun;
      std::string size = light.radius > 0 ? fmt::format(", radius {:.3g} m", light.radius) : "";
      if (is_sun && light.outer > 0) size = fmt::format(", angle {:.3g} degrees", light.outer * 360 / kPi);
      return fmt::format("{:<24}{}, {} {}{}, light group {}", light.name,
                         light.distribution >= 0 ? "photometric" : Light::kKindNames[std::size_t(light.kind)],
                         triple(Vec3d(light.strength)), is_sun ? "W/m2" : "W/sr", size,
                         scene.light_groups[light.light_group]);
    });
  if (scene.environment)
    text += fmt::format("environment\n  {} x {} texels, light group {}\n", scene.environment->width,
                        scene.environment->height, scene.light_groups[scene.environment->light_group]);
  text += describe_names("cameras", scene.cameras, [](const Camera& c) {
    const bool perspective = c.projection == Camera::Projection::perspective;
    return fmt::format("{:<24}{}, {:.4g} {} high{}{}", c.name, perspective ? "perspective" : "orthographic",
                       perspective ? c.vertical * 180 / kPi : 2 * c.vertical, perspective ? "degrees" : "m",
                       describe_lens(c),
                       c.motion.empty() ? "" : fmt::format(", moves until {:.4g} s", end_of_motion(c)));
  });
  return text;
}

std::string describe(const Transport& transport) {
  const auto n = double(std::max<std::int64_t>(transport.rows(), 1));
  std::string text = fmt::format("rows        {}, {:.4g} form factors each\n", transport.rows(),
                                 double(transport.columns.size() + transport.sky_columns.size()) / n);
  if (!transport.mirrored.empty())
    text += fmt::format("by mirrors  {:.4g} each\n", double(transport.mirrored.size()) / n);
  text += fmt::format("emitters    {} sampled apart\n", transport.emitters.size());
  return text;
}

std::string describe(const EnergyField& energy) {
  std::string text = fmt::format("method      {} over {}\n", energy.method, energy.form_factors);
  text += fmt::format("solve       {} {}, {} rays, residual {:.3g}, {:.2f} s\n", energy.iterations,
                      energy.method == "matrix" ? "iterations" : "shots", energy.rays, energy.residual, energy.seconds);
  if (const auto& e = energy.estimate)
    text +=
        fmt::format("error       {:.2g}%, below {:.2g}% in 19 of 20 solves\n", 100 * e->error, 100 * e->error_bound);
  if (const auto& e = energy.estimate; e && e->error_local != e->kUnknown)
    text += fmt::format("local error {:.2g}%, below {:.2g}% on 95% of the area\n", 100 * e->error_local_estimate,
                        100 * e->error_local);
  text += "light groups (largest irradiance, W/m2)\n";
  for (const auto& group : energy.groups) {
    float direct = 0, indirect = 0;
    for (const Color& c : group.direct) direct = std::max({direct, c.x, c.y, c.z});
    for (const Color& c : group.indirect) indirect = std::max({indirect, c.x, c.y, c.z});
    text += fmt::format("  {:<24}direct {:.4g}, indirect {:.4g}\n", group.name, direct, indirect);
  }
  return text;
}

}  // namespace patchlight

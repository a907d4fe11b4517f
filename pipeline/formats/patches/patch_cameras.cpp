#include "pipeline/formats/patches/patch_cameras.h"

#include <algorithm>
#include <cmath>

#include "pipeline/formats/patches/patch_rows.h"

namespace patchlight {

namespace {

/// Removes and returns the first `count` values.
std::vector<double> take(std::span<const double>& values, std::int64_t count, const H5Reader& reader,
                         const std::string& name) {
  if (count > std::int64_t(values.size())) reader.refuse("too few values for the keyframes", name);
  const auto taken = values.first(std::size_t(count));
  values = values.subspan(std::size_t(count));
  if (!std::all_of(taken.begin(), taken.end(), [](double x) { return std::isfinite(x); }))
    reader.refuse("a number that is not finite", name);
  return {taken.begin(), taken.end()};
}

void write_cameras(H5Writer& writer, const std::vector<Camera>& cameras) {
  using C = const Camera&;
  std::vector<std::string> names;
  for (const auto& c : cameras) names.push_back(c.name);
  writer.strings("/cameras/name", names);
  write_rows<std::int32_t>(writer, "/cameras/projection", cameras, 0,
                           [](C c, auto* r) { *r = std::int32_t(c.projection); });
  write_rows<double>(writer, "/cameras/to_world", cameras, 16,
                     [](C c, auto* r) { std::copy_n(&c.to_world.x[0][0], 16, r); });
  write_rows<double>(writer, "/cameras/lens", cameras, 2, [](C c, auto* r) {
    r[0] = c.vertical;
    r[1] = c.aspect;
  });
  const Camera plain;
  const auto write_pairs = [&](const std::string& name, auto differs, auto pair) {
    if (std::any_of(cameras.begin(), cameras.end(), differs)) write_rows<double>(writer, name, cameras, 2, pair);
  };
  write_pairs(
      "/cameras/shift", [&](C c) { return c.shift != plain.shift; },
      [](C c, auto* r) { std::copy_n(&c.shift.x, 2, r); });
  write_pairs(
      "/cameras/clip", [&](C c) { return c.znear != plain.znear || c.zfar != plain.zfar; },
      [](C c, auto* r) {
        r[0] = c.znear;
        r[1] = c.zfar;
      });
  write_pairs(
      "/cameras/aperture", [&](C c) { return c.aperture != plain.aperture || c.focus != plain.focus; },
      [](C c, auto* r) {
        r[0] = c.aperture;
        r[1] = c.focus;
      });
}

void write_motions(H5Writer& writer, const PatchSet& scene) {
  std::vector<std::int32_t> cameras, kinds, interpolations, keys;
  std::vector<double> times, values;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i)
    for (const Motion& factor : scene.cameras[i].motion) {
      cameras.push_back(std::int32_t(i));
      kinds.push_back(std::int32_t(factor.kind));
      interpolations.push_back(std::int32_t(factor.interpolation));
      keys.push_back(std::int32_t(factor.times.size()));
      times.insert(times.end(), factor.times.begin(), factor.times.end());
      values.insert(values.end(), factor.values.begin(), factor.values.end());
    }
  if (cameras.empty()) return;
  writer.dataset<std::int32_t>("/motions/camera", cameras);
  writer.dataset<std::int32_t>("/motions/kind", kinds);
  writer.dataset<std::int32_t>("/motions/interpolation", interpolations);
  writer.dataset<std::int32_t>("/motions/keys", keys);
  writer.dataset<double>("/motions/time", times);
  writer.dataset<double>("/motions/value", values);
}

void read_cameras(const H5Reader& reader, std::vector<Camera>& cameras) {
  using C = Camera&;
  for (const auto& name : reader.strings("/cameras/name", -1)) cameras.emplace_back().name = name;
  read_rows<std::int32_t>(reader, "/cameras/projection", cameras, 0, [&](C c, auto* r) {
    if (*r != 0 && *r != 1) reader.refuse("unknown projection", "/cameras/projection");
    c.projection = Camera::Projection(*r);
  });
  read_rows<double>(reader, "/cameras/to_world", cameras, 16,
                    [](C c, auto* r) { std::copy_n(r, 16, &c.to_world.x[0][0]); });
  read_rows<double>(reader, "/cameras/lens", cameras, 2, [](C c, auto* r) {
    c.vertical = r[0];
    c.aspect = r[1];
  });
  const auto read_pairs = [&](const std::string& name, auto set) {
    if (reader.has(name)) read_rows<double>(reader, name, cameras, 2, set);
  };
  read_pairs("/cameras/shift", [](C c, auto* r) { c.shift = {r[0], r[1]}; });
  read_pairs("/cameras/clip", [](C c, auto* r) {
    c.znear = r[0];
    c.zfar = r[1];
  });
  read_pairs("/cameras/aperture", [](C c, auto* r) {
    c.aperture = r[0];
    c.focus = r[1];
  });
}

void read_motions(const H5Reader& reader, PatchSet& scene) {
  if (!reader.has("/motions/camera")) return;
  const std::vector<std::int32_t> cameras = reader.dataset<std::int32_t>("/motions/camera", -1);
  const auto count = std::int64_t(cameras.size());
  const auto column = [&](const std::string& name, std::int32_t most) {
    std::vector<std::int32_t> values = reader.dataset<std::int32_t>(name, count);
    for (const std::int32_t value : values)
      if (value < 0 || value > most) reader.refuse("a value out of range", name);
    return values;
  };
  const auto kinds = column("/motions/kind", 3), interpolations = column("/motions/interpolation", 2);
  const auto keys = column("/motions/keys", INT32_MAX);
  const std::vector<double> times = reader.dataset<double>("/motions/time", -1);
  const std::vector<double> values = reader.dataset<double>("/motions/value", -1);
  std::span<const double> time_left = times, value_left = values;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (cameras[i] < 0 || std::size_t(cameras[i]) >= scene.cameras.size())
      reader.refuse("an index out of range", "/motions/camera");
    Motion factor;
    factor.kind = Motion::Kind(kinds[i]);
    factor.interpolation = Motion::Interpolation(interpolations[i]);
    if ((factor.kind == Motion::Kind::fixed) != (keys[i] == 0))
      reader.refuse("keyframes of a constant factor, or none of an animated one", "/motions/keys");
    factor.times = take(time_left, keys[i], reader, "/motions/time");
    factor.values = take(value_left, std::max<std::int64_t>(1, keys[i]) * factor.stride(), reader, "/motions/value");
    if (!std::is_sorted(factor.times.begin(), factor.times.end()))
      reader.refuse("keyframe times that are not ascending", "/motions/time");
    scene.cameras[cameras[i]].motion.push_back(std::move(factor));
  }
}

}  // namespace

void write_camera_datasets(H5Writer& writer, const PatchSet& scene) {
  write_cameras(writer, scene.cameras);
  write_motions(writer, scene);
}

void read_camera_datasets(const H5Reader& reader, PatchSet& scene) {
  read_cameras(reader, scene.cameras);
  read_motions(reader, scene);
}

}  // namespace patchlight

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/driver/commands.h"
#include "pipeline/files/energy_file.h"
#include "pipeline/files/file_kind.h"
#include "pipeline/files/image_file.h"
#include "pipeline/files/patch_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

/// A file as named columns of numbers.
using Columns = std::vector<std::pair<std::string, std::vector<double>>>;

template <class Items, class Get>
void add_column(Columns& columns, const std::string& name, const Items& items, Get get) {
  std::vector<double> values;
  for (const auto& item : items) get(item, values);
  columns.emplace_back(name, std::move(values));
}

template <class Vector>
void put(std::vector<double>& values, const Vector& v) {
  values.insert(values.end(), {double(v.x), double(v.y), double(v.z)});
}

Columns patch_columns(const std::string& file) {
  const PatchSet scene = read_patches(file);
  Columns columns;
  using P = const Patch&;
  using Out = std::vector<double>&;
  add_column(columns, "/patches/center", scene.patches, [](P p, Out out) { put(out, p.center); });
  add_column(columns, "/patches/normal", scene.patches, [](P p, Out out) { put(out, p.normal); });
  add_column(columns, "/patches/area", scene.patches, [](P p, Out out) { out.push_back(p.area); });
  add_column(columns, "/patches/reflectance", scene.patches, [](P p, Out out) { put(out, p.reflectance); });
  add_column(columns, "/patches/emission", scene.patches, [](P p, Out out) { put(out, p.emission); });
  add_column(columns, "/patches/primitive", scene.patches, [](P p, Out out) { out.push_back(p.primitive); });
  add_column(columns, "/patches/uv", scene.patches, [](P p, Out out) {
    out.insert(out.end(), {p.u0, p.v0, p.u1, p.v1});
  });
  using Q = const Primitive&;
  add_column(columns, "/primitives/type", scene.primitives, [](Q q, Out out) { out.push_back(double(q.shape)); });
  add_column(columns, "/primitives/corners", scene.primitives, [](Q q, Out out) {
    for (const auto& corner : q.corners) put(out, corner);
  });
  add_column(columns, "/primitives/sphere", scene.primitives, [](Q q, Out out) {
    put(out, q.sphere_center);
    out.push_back(q.sphere_radius);
  });
  add_column(columns, "/materials/specular", scene.materials, [](const Material& m, Out out) { put(out, m.specular); });
  add_column(columns, "/cameras/to_world", scene.cameras,
             [](const Camera& c, Out out) { out.insert(out.end(), &c.to_world.x[0][0], &c.to_world.x[0][0] + 16); });
  return columns;
}

Columns energy_columns(const std::string& file) {
  Columns columns;
  const auto put_color = [](const Color& c, std::vector<double>& out) { put(out, c); };
  for (const auto& group : read_energy(file).groups) {
    add_column(columns, "/groups/" + group.name + "/direct", group.direct, put_color);
    add_column(columns, "/groups/" + group.name + "/indirect", group.indirect, put_color);
  }
  return columns;
}

Columns frame_columns(const std::string& file) {
  const Image image = read_exr(file);
  Columns columns{{"size", {double(image.width), double(image.height)}}};
  add_column(columns, "R, G, B", image.pixels, [](const Color& c, std::vector<double>& out) { put(out, c); });
  return columns;
}

Columns read_columns(const std::string& file, FileKind kind) {
  if (kind == FileKind::patches) return patch_columns(file);
  if (kind == FileKind::energy) return energy_columns(file);
  return frame_columns(file);
}

/// Prints a line on one column. Returns whether the difference is allowed.
bool compare(const DiffCommand& command, const std::string& name, const std::vector<double>& a,
             const std::vector<double>& b) {
  if (a.size() != b.size()) {
    fmt::print("{:<40}differs: {} values against {}\n", name, a.size(), b.size());
    return false;
  }
  double square = 0, difference = 0, largest = 0, largest_difference = 0;
  std::size_t unequal = 0, where = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = std::abs(a[i] - b[i]);
    unequal += a[i] != b[i];
    square += a[i] * a[i];
    difference += d * d;
    largest = std::max(largest, std::abs(a[i]));
    if (d > largest_difference) where = i;
    largest_difference = std::max(largest_difference, d);
  }
  if (unequal == 0) return true;
  const double rms = square > 0 ? std::sqrt(difference / square) : INFINITY;
  const double peak = largest > 0 ? largest_difference / largest : INFINITY;
  const bool allowed = rms <= command.tolerance && (!command.max || peak <= *command.max);
  fmt::print("{:<40}{}: {} of {} values, relative RMS {:.3g}, largest {:.3g} at value {}\n", name,
             allowed ? "within tolerance" : "differs", unequal, a.size(), rms, peak, where);
  return allowed;
}

}  // namespace

int compare_files(const DiffCommand& command) {
  const FileKind kind = kind_of(command.a);
  if (kind == FileKind::scene || kind != kind_of(command.b))
    throw Error(ExitCode::bad_data, "not two files of one kind that Patchlight writes", command.a + ", " + command.b,
                "name two patches.h5, two energy.h5 or two EXR frames");
  const Columns a = read_columns(command.a, kind), b = read_columns(command.b, kind);
  bool same = a.size() == b.size();
  if (!same) fmt::print("differs: {} light groups against {}\n", a.size() / 2, b.size() / 2);
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (a[i].first != b[i].first) {
      fmt::print("{:<40}differs: {} in its place\n", a[i].first, b[i].first);
      same = false;
    } else {
      same = compare(command, a[i].first, a[i].second, b[i].second) && same;
    }
  }
  if (same) fmt::print("no difference beyond the tolerance\n");
  return same ? 0 : 1;
}

}  // namespace patchlight

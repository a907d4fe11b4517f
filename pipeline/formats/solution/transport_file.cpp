#include "pipeline/formats/solution/transport_file.h"

#include <cmath>

#include "pipeline/formats/solution/display_mesh_file.h"
#include "pipeline/formats/solution/transport_rows_file.h"
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/hdf5/provenance_file.h"

namespace patchlight {

namespace {

constexpr std::int64_t kMaxCells = 1 << 20;
const char* const kLights = "/emitters/light";

/// Colours of both sample sets of an emitter's rows; empty if the file has none.
std::vector<Color> read_row_colors(const H5Reader& reader, const std::string& name, std::int64_t rows) {
  std::vector<Color> colors;
  if (!reader.has(name)) return colors;
  const std::vector<float> values = reader.dataset<float>(name, 2 * rows, 3);
  check_all(reader, name, values, [](float value) { return std::isfinite(value) && value >= 0; });
  for (std::size_t k = 0; k < values.size(); k += 3) colors.emplace_back(values[k], values[k + 1], values[k + 2]);
  return colors;
}

void write_row_colors(H5Writer& writer, const std::string& name, const std::vector<Color>& colors) {
  if (colors.empty()) return;
  std::vector<float> values;
  for (const Color& c : colors) values.insert(values.end(), {c.x, c.y, c.z});
  writer.dataset<float>(name, values, 3);
}

/// Name of an emitter's datasets. `number`: its index in the file.
std::string emitter_name(const Transport::Emitter& emitter, std::size_t number) {
  return emitter.light == 0 ? std::to_string(emitter.first_patch) : "light_" + std::to_string(number);
}

void read_emitters(const H5Reader& reader, std::int64_t patches, Transport& transport) {
  const std::vector<std::int32_t> ranges = reader.dataset<std::int32_t>("/emitters/patches", -1, 2);
  std::vector<std::int64_t> lights;
  if (reader.has(kLights)) lights = reader.dataset<std::int64_t>(kLights, -1);
  check_all(reader, kLights, lights, [](std::int64_t light) { return light != 0; });
  std::int64_t last = 0;
  for (std::size_t k = 0; k < ranges.size(); k += 2) {
    if (ranges[k] < last || ranges[k + 1] < 1 || std::int64_t(ranges[k]) + ranges[k + 1] > patches)
      reader.refuse("a range out of bounds or order", "/emitters/patches");
    last = std::int64_t(ranges[k]) + ranges[k + 1];
    transport.emitters.push_back({ranges[k], ranges[k + 1], {}});
  }
  for (const std::int64_t light : lights) transport.emitters.push_back({std::int32_t(patches), 0, {}, {}, {}, light});
  for (std::size_t k = 0; k < transport.emitters.size(); ++k) {
    Transport::Emitter& emitter = transport.emitters[k];
    const std::string own = emitter_name(emitter, k);
    const auto factors = [&](const std::string& folder, std::int64_t rows) {
      const std::string name = folder + "/" + own;
      std::vector<float> values = reader.dataset<float>(name, rows, 2);
      check_all(reader, name, values, is_factor);
      return values;
    };
    emitter.factors = factors("/emitters/factor", patches);
    if (transport.display) emitter.display = factors("/display/factor", transport.display->mesh.elements());
    emitter.tints = read_row_colors(reader, "/emitters/tint/" + own, patches);
    if (transport.display)
      emitter.display_tints = read_row_colors(reader, "/display/tint/" + own, transport.display->mesh.elements());
    emitter.mirrored = read_row_colors(reader, "/emitters/mirrored/" + own, patches);
    if (emitter.mirrored.empty() != transport.emitters.front().mirrored.empty())
      reader.refuse("photons of some emitters only", "/emitters/patches");
  }
}

void read_display(const H5Reader& reader, std::int64_t patches, Transport& transport) {
  if (!reader.has("/display/rows/start")) return;
  auto& display = transport.display.emplace();
  display.mesh = read_display_mesh(reader, patches);
  read_rows(reader, "/display", patches + display.mesh.elements() + transport.sky, false,
            reader.integer("display_rays"), display.rows);
  if (display.rows.rows() != display.mesh.gathered)
    reader.refuse("unequal numbers of rows and vertices", "/display/rows/start");
}

void write_lights(H5Writer& writer, const std::string& folder, const LightRows& lights) {
  if (lights.starts.empty()) return;
  writer.dataset<std::int64_t>(folder + "/lights/start",
                               std::vector<std::int64_t>(lights.starts.begin(), lights.starts.end()));
  writer.dataset<std::int32_t>(folder + "/lights/patch", lights.patches);
  writer.dataset<float>(folder + "/lights/weight", lights.weights);
}

LightRows read_lights(const H5Reader& reader, const std::string& folder, std::int64_t rows, std::int64_t patches) {
  LightRows lights;
  if (!reader.has(folder + "/lights/start")) return lights;
  const auto starts = reader.dataset<std::int64_t>(folder + "/lights/start", 2 * rows + 1);
  lights.patches = reader.dataset<std::int32_t>(folder + "/lights/patch", -1);
  lights.weights = reader.dataset<float>(folder + "/lights/weight", std::int64_t(lights.patches.size()));
  if (starts.front() != 0 || starts.back() != std::int64_t(lights.patches.size()) ||
      !std::is_sorted(starts.begin(), starts.end()))
    reader.refuse("row starts that are not ascending", folder + "/lights/start");
  lights.starts.assign(starts.begin(), starts.end());
  check_all(reader, folder + "/lights/patch", lights.patches, [=](std::int32_t j) { return j >= 0 && j < patches; });
  check_all(reader, folder + "/lights/weight", lights.weights, is_factor);
  return lights;
}

Transport read_all(const H5Reader& reader) {
  Transport transport;
  transport.key = reader.text("key");
  if (reader.has_attribute("sky")) {
    const std::int64_t sky = reader.integer("sky");
    if (sky < 1 || sky > kMaxCells) reader.refuse("a number of cells out of bounds", "sky");
    transport.sky = int(sky);
  }
  read_rows(reader, "", transport.sky, true, reader.integer("rays"), transport);
  transport.visible_fractions = read_visible_fractions(reader, transport.rows());
  read_display(reader, transport.rows(), transport);
  if (reader.has_attribute("lights")) {
    transport.lights_id = reader.integer("lights");
    transport.lights = read_lights(reader, "", transport.rows(), transport.rows());
    if (transport.display)
      transport.display->lights = read_lights(reader, "/display", transport.display->mesh.gathered, transport.rows());
  }
  read_emitters(reader, transport.rows(), transport);
  return transport;
}

}  // namespace

void write_transport(const std::filesystem::path& file, const Transport& transport) {
  H5Writer writer(file);
  write_rows(writer, "", transport);
  if (!transport.visible_fractions.empty()) writer.dataset<float>("/exposed", transport.visible_fractions, 2);
  if (transport.display) {
    write_display_mesh(writer, transport.display->mesh);
    write_rows(writer, "/display", transport.display->rows);
    write_lights(writer, "/display", transport.display->lights);
  }
  write_lights(writer, "", transport.lights);
  std::vector<std::int32_t> ranges;
  std::vector<std::int64_t> lights;
  for (std::size_t k = 0; k < transport.emitters.size(); ++k) {
    const Transport::Emitter& emitter = transport.emitters[k];
    if (emitter.light == 0)
      ranges.insert(ranges.end(), {emitter.first_patch, emitter.patches});
    else
      lights.push_back(emitter.light);
    const std::string name = "/" + emitter_name(emitter, k);
    writer.dataset<float>("/emitters/factor" + name, emitter.factors, 2);
    if (transport.display) writer.dataset<float>("/display/factor" + name, emitter.display, 2);
    write_row_colors(writer, "/emitters/tint" + name, emitter.tints);
    if (transport.display) write_row_colors(writer, "/display/tint" + name, emitter.display_tints);
    write_row_colors(writer, "/emitters/mirrored" + name, emitter.mirrored);
  }
  writer.dataset<std::int32_t>("/emitters/patches", ranges, 2);
  if (!lights.empty()) writer.dataset<std::int64_t>(kLights, lights);
  writer.attribute("format", kTransportFormat);
  writer.attribute("version", std::int64_t(kTransportVersion));
  writer.attribute("key", transport.key);
  write_provenance(writer, transport.made);
  writer.attribute("rays", std::int64_t(transport.rays));
  if (transport.lights_id != 0) writer.attribute("lights", transport.lights_id);
  if (transport.sky > 0) writer.attribute("sky", std::int64_t(transport.sky));
  if (transport.display) writer.attribute("display_rays", std::int64_t(transport.display->rows.rays));
  writer.commit();
}

Transport read_transport(const std::filesystem::path& file) {
  return read_all(H5Reader(file, kTransportFormat, kTransportVersion));
}

std::optional<Transport> read_transport(const std::filesystem::path& file, const std::string& key) {
  const H5Reader reader(file, kTransportFormat, kTransportVersion);
  if (reader.text("key") != key) return std::nullopt;
  return read_all(reader);
}

std::string read_transport_key(const std::filesystem::path& file) {
  return H5Reader(file, kTransportFormat, kTransportVersion).text("key");
}

}  // namespace patchlight

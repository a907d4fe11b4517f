#include "pipeline/files/transport_file.h"

#include <algorithm>
#include <cmath>

#include "pipeline/files/display_mesh_file.h"
#include "pipeline/files/h5_store.h"
#include "pipeline/files/provenance_file.h"

namespace patchlight {

namespace {

constexpr std::int64_t kMostRays = 1 << 24;
constexpr std::int64_t kMostCells = 1 << 20;
const char* const kLights = "/emitters/light";

void write_rows(H5Writer& writer, const std::string& folder, const TransportRows& rows) {
  const std::vector<std::int64_t> starts(rows.starts.begin(), rows.starts.end());
  writer.dataset<std::int64_t>(folder + "/rows/start", starts);
  writer.dataset<std::int32_t>(folder + "/rows/patch", rows.ends);
  if (rows.rays == 0)
    writer.dataset<float>(folder + "/rows/weight", rows.weights);
  else
    writer.dataset<float>(folder + "/rows/share", rows.shares);
  if (rows.mirrored.empty()) return;
  std::vector<std::int32_t> places;
  std::vector<float> weights;
  for (const auto& m : rows.mirrored) {
    places.insert(places.end(), {m.row, m.half, m.patch});
    weights.insert(weights.end(), {m.weight.x, m.weight.y, m.weight.z});
  }
  writer.dataset<std::int32_t>(folder + "/mirrored/place", places, 3);
  writer.dataset<float>(folder + "/mirrored/weight", weights, 3);
}

/// Refuses the dataset unless `good` holds for every value.
template <class Values, class Good>
void check_all(const H5Reader& reader, const std::string& dataset, const Values& values, Good good) {
  if (!std::all_of(values.begin(), values.end(), good)) reader.refuse("a value out of bounds", dataset);
}

bool is_factor(float value) {
  return std::isfinite(value);
}

void read_mirrored(const H5Reader& reader, const std::string& folder, std::int64_t elements, TransportRows& rows) {
  if (!reader.has(folder + "/mirrored/place")) return;
  const std::vector<std::int32_t> places = reader.dataset<std::int32_t>(folder + "/mirrored/place", -1, 3);
  const std::vector<float> weights =
      reader.dataset<float>(folder + "/mirrored/weight", std::int64_t(places.size() / 3), 3);
  check_all(reader, folder + "/mirrored/weight", weights, is_factor);
  std::int64_t last = 0;
  for (std::size_t k = 0; k < places.size(); k += 3) {
    const std::int32_t row = places[k], half = places[k + 1], patch = places[k + 2];
    if (row < 0 || row >= rows.rows() || half < 0 || half > 1 || patch < 0 || patch >= elements ||
        2 * std::int64_t(row) + half < last)
      reader.refuse("a place out of bounds or order", folder + "/mirrored/place");
    last = 2 * std::int64_t(row) + half;
    rows.mirrored.push_back({row, half, patch, Color(weights[k], weights[k + 1], weights[k + 2])});
  }
}

/// `elements` that rows may end on, beside as many as there are rows if `own`. `rays` of a row; 0: not by rays.
void read_rows(const H5Reader& reader, const std::string& folder, std::int64_t elements, bool own, std::int64_t rays,
               TransportRows& rows) {
  if (rays < 0 || rays > kMostRays) reader.refuse("a number of rays out of bounds", folder + "/rows/share");
  const std::vector<std::int64_t> starts = reader.dataset<std::int64_t>(folder + "/rows/start", -1);
  rows.ends = reader.dataset<std::int32_t>(folder + "/rows/patch", -1);
  if (starts.size() % 2 == 0 || starts.front() != 0 || starts.back() != std::int64_t(rows.ends.size()) ||
      !std::is_sorted(starts.begin(), starts.end()))
    reader.refuse("rows that do not follow each other", folder + "/rows/start");
  rows.starts.assign(starts.begin(), starts.end());
  if (own) elements += rows.rows();
  check_all(reader, folder + "/rows/patch", rows.ends, [&](std::int32_t j) { return j >= 0 && j < elements; });
  if (rays == 0) {
    rows.weights = reader.dataset<float>(folder + "/rows/weight", std::int64_t(rows.ends.size()));
    check_all(reader, folder + "/rows/weight", rows.weights, is_factor);
  } else {
    rows.rays = int(rays);
    rows.shares = reader.dataset<float>(folder + "/rows/share", std::int64_t(starts.size() - 1));
    check_all(reader, folder + "/rows/share", rows.shares, [](float share) { return share >= 0 && share <= 1; });
  }
  read_mirrored(reader, folder, elements, rows);
}

/// What an emitter sends by way of mirrors; empty where it says nothing of it.
std::vector<Color> read_photons(const H5Reader& reader, const std::string& emitter, std::int64_t patches) {
  const std::string name = "/emitters/mirrored/" + emitter;
  std::vector<Color> photons;
  if (!reader.has(name)) return photons;
  const std::vector<float> values = reader.dataset<float>(name, 2 * patches, 3);
  check_all(reader, name, values, [](float value) { return std::isfinite(value) && value >= 0; });
  for (std::size_t k = 0; k < values.size(); k += 3) photons.emplace_back(values[k], values[k + 1], values[k + 2]);
  return photons;
}

/// The `number`th emitter of the file as its datasets are named.
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
    if (transport.display) emitter.display = factors("/display/factor", transport.display->mesh.elements);
    emitter.mirrored = read_photons(reader, own, patches);
    if (emitter.mirrored.empty() != transport.emitters.front().mirrored.empty())
      reader.refuse("photons of some emitters alone", "/emitters/patches");
  }
}

void read_display(const H5Reader& reader, std::int64_t patches, Transport& transport) {
  if (!reader.has("/display/rows/start")) return;
  auto& display = transport.display.emplace();
  display.mesh = read_display_mesh(reader, patches);
  read_rows(reader, "/display", patches + display.mesh.elements + transport.sky, false, reader.integer("display_rays"),
            display.rows);
  if (display.rows.rows() != display.mesh.gathered)
    reader.refuse("another number of rows than of vertices", "/display/rows/start");
}

Transport read_all(const H5Reader& reader) {
  Transport transport;
  transport.key = reader.text("key");
  if (reader.has_attribute("sky")) {
    const std::int64_t sky = reader.integer("sky");
    if (sky < 1 || sky > kMostCells) reader.refuse("a number of cells out of bounds", "sky");
    transport.sky = int(sky);
  }
  read_rows(reader, "", transport.sky, true, reader.integer("rays"), transport);
  if (reader.has("/exposed")) {
    transport.exposed = reader.dataset<float>("/exposed", transport.rows(), 2);
    check_all(reader, "/exposed", transport.exposed, [](float part) { return part > 0 && part <= 1; });
  }
  read_display(reader, transport.rows(), transport);
  read_emitters(reader, transport.rows(), transport);
  return transport;
}

}  // namespace

void write_transport(const std::filesystem::path& file, const Transport& transport) {
  H5Writer writer(file);
  write_rows(writer, "", transport);
  if (!transport.exposed.empty()) writer.dataset<float>("/exposed", transport.exposed, 2);
  if (transport.display) {
    write_display_mesh(writer, transport.display->mesh);
    write_rows(writer, "/display", transport.display->rows);
  }
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
    if (emitter.mirrored.empty()) continue;
    std::vector<float> photons;
    for (const Color& c : emitter.mirrored) photons.insert(photons.end(), {c.x, c.y, c.z});
    writer.dataset<float>("/emitters/mirrored" + name, photons, 3);
  }
  writer.dataset<std::int32_t>("/emitters/patches", ranges, 2);
  if (!lights.empty()) writer.dataset<std::int64_t>(kLights, lights);
  writer.attribute("format", kTransportFormat);
  writer.attribute("version", std::int64_t(kTransportVersion));
  writer.attribute("key", transport.key);
  write_provenance(writer, transport.made);
  writer.attribute("rays", std::int64_t(transport.rays));
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

#include "pipeline/files/transport_file.h"

#include <algorithm>
#include <cmath>

#include "pipeline/files/h5_store.h"

namespace patchlight {

namespace {

void write_mirrored(H5Writer& writer, const std::vector<Transport::Mirrored>& mirrored) {
  std::vector<std::int32_t> places;
  std::vector<float> weights;
  for (const auto& m : mirrored) {
    places.insert(places.end(), {m.row, m.half, m.patch});
    weights.insert(weights.end(), {m.weight.x, m.weight.y, m.weight.z});
  }
  writer.dataset<std::int32_t>("/mirrored/place", places, 3);
  writer.dataset<float>("/mirrored/weight", weights, 3);
}

/// Refuses the dataset unless `good` holds for every value.
template <class Values, class Good>
void check_all(const H5Reader& reader, const std::string& dataset, const Values& values, Good good) {
  if (!std::all_of(values.begin(), values.end(), good)) reader.refuse("a value out of bounds", dataset);
}

bool is_factor(float value) {
  return std::isfinite(value);
}

void read_rows(const H5Reader& reader, Transport& transport) {
  const std::vector<std::int64_t> starts = reader.dataset<std::int64_t>("/rows/start", -1);
  transport.ends = reader.dataset<std::int32_t>("/rows/patch", -1);
  if (starts.size() % 2 == 0 || starts.front() != 0 || starts.back() != std::int64_t(transport.ends.size()) ||
      !std::is_sorted(starts.begin(), starts.end()))
    reader.refuse("rows that do not follow each other", "/rows/start");
  transport.starts.assign(starts.begin(), starts.end());
  const std::int64_t patches = transport.rows();
  check_all(reader, "/rows/patch", transport.ends, [&](std::int32_t j) { return j >= 0 && j <= patches; });
  if (!reader.has("/rows/weight")) return;
  transport.weights = reader.dataset<float>("/rows/weight", std::int64_t(transport.ends.size()));
  check_all(reader, "/rows/weight", transport.weights, is_factor);
}

void read_mirrored(const H5Reader& reader, std::int64_t patches, Transport& transport) {
  if (!reader.has("/mirrored/place")) return;
  const std::vector<std::int32_t> places = reader.dataset<std::int32_t>("/mirrored/place", -1, 3);
  const std::vector<float> weights = reader.dataset<float>("/mirrored/weight", std::int64_t(places.size() / 3), 3);
  check_all(reader, "/mirrored/weight", weights, is_factor);
  std::int64_t last = 0;
  for (std::size_t k = 0; k < places.size(); k += 3) {
    const std::int32_t row = places[k], half = places[k + 1], patch = places[k + 2];
    if (row < 0 || row >= patches || half < 0 || half > 1 || patch < 0 || patch >= patches ||
        2 * std::int64_t(row) + half < last)
      reader.refuse("a place out of bounds or order", "/mirrored/place");
    last = 2 * std::int64_t(row) + half;
    transport.mirrored.push_back({row, half, patch, Color(weights[k], weights[k + 1], weights[k + 2])});
  }
}

void read_emitters(const H5Reader& reader, std::int64_t patches, Transport& transport) {
  const std::vector<std::int32_t> ranges = reader.dataset<std::int32_t>("/emitters/patches", -1, 2);
  std::int64_t last = 0;
  for (std::size_t k = 0; k < ranges.size(); k += 2) {
    if (ranges[k] < last || ranges[k + 1] < 1 || std::int64_t(ranges[k]) + ranges[k + 1] > patches)
      reader.refuse("a range out of bounds or order", "/emitters/patches");
    last = std::int64_t(ranges[k]) + ranges[k + 1];
    const std::string name = "/emitters/factor/" + std::to_string(ranges[k]);
    transport.emitters.push_back({ranges[k], ranges[k + 1], reader.dataset<float>(name, patches, 2)});
    check_all(reader, name, transport.emitters.back().factors, is_factor);
  }
}

}  // namespace

void write_transport(const std::filesystem::path& file, const Transport& transport) {
  H5Writer writer(file);
  const std::vector<std::int64_t> starts(transport.starts.begin(), transport.starts.end());
  writer.dataset<std::int64_t>("/rows/start", starts);
  writer.dataset<std::int32_t>("/rows/patch", transport.ends);
  if (!transport.weights.empty()) writer.dataset<float>("/rows/weight", transport.weights);
  if (!transport.mirrored.empty()) write_mirrored(writer, transport.mirrored);
  std::vector<std::int32_t> ranges;
  for (const auto& emitter : transport.emitters) {
    ranges.insert(ranges.end(), {emitter.first_patch, emitter.patches});
    writer.dataset<float>("/emitters/factor/" + std::to_string(emitter.first_patch), emitter.factors, 2);
  }
  writer.dataset<std::int32_t>("/emitters/patches", ranges, 2);
  writer.attribute("format", kTransportFormat);
  writer.attribute("version", std::int64_t(kTransportVersion));
  writer.attribute("key", transport.key);
  writer.commit();
}

Transport read_transport(const std::filesystem::path& file) {
  const H5Reader reader(file, kTransportFormat, kTransportVersion);
  Transport transport;
  transport.key = reader.text("key");
  read_rows(reader, transport);
  const std::int64_t patches = transport.rows();
  read_mirrored(reader, patches, transport);
  read_emitters(reader, patches, transport);
  return transport;
}

std::string read_transport_key(const std::filesystem::path& file) {
  return H5Reader(file, kTransportFormat, kTransportVersion).text("key");
}

}  // namespace patchlight

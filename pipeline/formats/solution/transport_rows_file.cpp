#include "pipeline/formats/solution/transport_rows_file.h"

#include <algorithm>
#include <limits>

namespace patchlight {

namespace {

constexpr std::int64_t kMaxRays = 1 << 24;

void read_mirrored(const H5Reader& reader, const std::string& folder, std::int64_t elements, TransportRows& rows) {
  if (!reader.has(folder + "/mirrored/place")) return;
  const std::vector<std::int32_t> entries = reader.dataset<std::int32_t>(folder + "/mirrored/place", -1, 3);
  const std::vector<float> weights =
      reader.dataset<float>(folder + "/mirrored/weight", std::int64_t(entries.size() / 3), 3);
  check_all(reader, folder + "/mirrored/weight", weights, is_factor);
  std::int64_t last = 0;
  for (std::size_t k = 0; k < entries.size(); k += 3) {
    const std::int32_t row = entries[k], sample_set = entries[k + 1], patch = entries[k + 2];
    if (row < 0 || row >= rows.rows() || sample_set < 0 || sample_set > 1 || patch < 0 || patch >= elements ||
        2 * std::int64_t(row) + sample_set < last)
      reader.refuse("an entry out of bounds or order", folder + "/mirrored/place");
    last = 2 * std::int64_t(row) + sample_set;
    rows.mirrored.push_back({row, sample_set, patch, Color(weights[k], weights[k + 1], weights[k + 2])});
  }
}

void check_starts(const H5Reader& reader, const std::string& dataset, const std::vector<std::int64_t>& starts,
                  std::size_t columns) {
  if (starts.size() % 2 == 0 || starts.front() != 0 || starts.back() != std::int64_t(columns) ||
      !std::is_sorted(starts.begin(), starts.end()))
    reader.refuse("row starts that are not ascending", dataset);
}

bool is_share(float weight) {
  return weight >= 0 && weight <= 1;
}

/// `elements`: number of all elements, of which the environment's cells are the last.
void read_sky(const H5Reader& reader, const std::string& folder, std::int64_t elements, TransportRows& rows) {
  if (!reader.has(folder + "/sky/start")) return;
  const std::vector<std::int64_t> starts =
      reader.dataset<std::int64_t>(folder + "/sky/start", std::int64_t(rows.starts.size()));
  rows.sky_columns = reader.dataset<std::int32_t>(folder + "/sky/patch", -1);
  check_starts(reader, folder + "/sky/start", starts, rows.sky_columns.size());
  rows.sky_starts.assign(starts.begin(), starts.end());
  check_all(reader, folder + "/sky/patch", rows.sky_columns,
            [=](std::int32_t j) { return j >= 0 && std::int64_t(j) < elements; });
  rows.sky_weights = reader.dataset<float>(folder + "/sky/share", std::int64_t(starts.size() - 1));
  check_all(reader, folder + "/sky/share", rows.sky_weights, is_share);
}

}  // namespace

void write_rows(H5Writer& writer, const std::string& folder, const TransportRows& rows) {
  const std::vector<std::int64_t> starts(rows.starts.begin(), rows.starts.end());
  writer.dataset<std::int64_t>(folder + "/rows/start", starts);
  writer.dataset<std::int32_t>(folder + "/rows/patch", rows.columns);
  if (rows.rays == 0)
    writer.dataset<float>(folder + "/rows/weight", rows.weights);
  else
    writer.dataset<float>(folder + "/rows/share", rows.hit_weights);
  if (!rows.sky_starts.empty()) {
    const std::vector<std::int64_t> sky_starts(rows.sky_starts.begin(), rows.sky_starts.end());
    writer.dataset<std::int64_t>(folder + "/sky/start", sky_starts);
    writer.dataset<std::int32_t>(folder + "/sky/patch", rows.sky_columns);
    writer.dataset<float>(folder + "/sky/share", rows.sky_weights);
  }
  if (rows.mirrored.empty()) return;
  std::vector<std::int32_t> entries;
  std::vector<float> weights;
  for (const auto& m : rows.mirrored) {
    entries.insert(entries.end(), {m.row, m.sample_set, m.patch});
    weights.insert(weights.end(), {m.weight.x, m.weight.y, m.weight.z});
  }
  writer.dataset<std::int32_t>(folder + "/mirrored/place", entries, 3);
  writer.dataset<float>(folder + "/mirrored/weight", weights, 3);
}

void read_rows(const H5Reader& reader, const std::string& folder, std::int64_t elements, bool own, std::int64_t rays,
               TransportRows& rows) {
  if (rays < 0 || rays > kMaxRays) reader.refuse("a number of rays out of bounds", folder + "/rows/share");
  const std::vector<std::int64_t> starts = reader.dataset<std::int64_t>(folder + "/rows/start", -1);
  rows.columns = reader.dataset<std::int32_t>(folder + "/rows/patch", -1);
  check_starts(reader, folder + "/rows/start", starts, rows.columns.size());
  rows.starts.assign(starts.begin(), starts.end());
  if (own) elements += rows.rows();
  const auto count = std::uint32_t(std::min<std::int64_t>(elements, std::numeric_limits<std::int32_t>::max()));
  check_all(reader, folder + "/rows/patch", rows.columns, [=](std::int32_t j) { return std::uint32_t(j) < count; });
  if (rays == 0) {
    rows.weights = reader.dataset<float>(folder + "/rows/weight", std::int64_t(rows.columns.size()));
    check_all(reader, folder + "/rows/weight", rows.weights, is_factor);
  } else {
    rows.rays = int(rays);
    rows.hit_weights = reader.dataset<float>(folder + "/rows/share", std::int64_t(starts.size() - 1));
    check_all(reader, folder + "/rows/share", rows.hit_weights, is_share);
  }
  read_sky(reader, folder, elements, rows);
  read_mirrored(reader, folder, elements, rows);
}

std::vector<float> read_visible_fractions(const H5Reader& reader, std::int64_t rows) {
  if (!reader.has("/exposed")) return {};
  std::vector<float> visible_fractions = reader.dataset<float>("/exposed", rows, 2);
  check_all(reader, "/exposed", visible_fractions, [](float fraction) { return fraction > 0 && fraction <= 1; });
  return visible_fractions;
}

}  // namespace patchlight

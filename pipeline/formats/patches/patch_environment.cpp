#include "pipeline/formats/patches/patch_environment.h"

#include <cmath>

namespace patchlight {

namespace {

constexpr std::int32_t kMaxRows = 512;

void write_colors(H5Writer& writer, const std::string& name, const std::vector<Color>& colors) {
  std::vector<float> values;
  values.reserve(3 * colors.size());
  for (const Color& c : colors) values.insert(values.end(), {c.x, c.y, c.z});
  writer.dataset<float>(name, values, 3);
}

std::vector<Color> read_colors(const H5Reader& reader, const std::string& name, std::int64_t count) {
  const std::vector<float> values = reader.dataset<float>(name, count, 3);
  std::vector<Color> colors;
  colors.reserve(values.size() / 3);
  for (std::size_t k = 0; k < values.size(); k += 3) {
    for (std::size_t c = k; c < k + 3; ++c)
      if (!(values[c] >= 0 && values[c] <= 3.4e38f)) reader.refuse("a negative or non-finite value", name);
    colors.emplace_back(values[k], values[k + 1], values[k + 2]);
  }
  return colors;
}

}  // namespace

void write_environment_datasets(H5Writer& writer, const PatchSet& scene) {
  if (!scene.environment) return;
  const Environment& sky = *scene.environment;
  writer.dataset<std::int32_t>("/environment/rows", std::vector{sky.rows});
  writer.dataset<std::int32_t>("/environment/light_group", std::vector{sky.light_group});
  writer.dataset<std::int32_t>("/environment/size", std::vector{sky.width, sky.height});
  writer.dataset<double>("/environment/view", std::vector{sky.turn, double(sky.clip)});
  write_colors(writer, "/environment/cells", sky.cells);
  write_colors(writer, "/environment/texels", sky.texels);
}

void read_environment_datasets(const H5Reader& reader, PatchSet& scene) {
  if (!reader.has("/environment/rows")) return;
  Environment& sky = scene.environment.emplace();
  sky.rows = reader.dataset<std::int32_t>("/environment/rows", 1)[0];
  if (sky.rows < 1 || sky.rows > kMaxRows) reader.refuse("a number out of bounds", "/environment/rows");
  sky.light_group = reader.dataset<std::int32_t>("/environment/light_group", 1)[0];
  if (sky.light_group < 0 || std::size_t(sky.light_group) >= scene.light_groups.size())
    reader.refuse("an index out of range", "/environment/light_group");
  const std::vector<std::int32_t> size = reader.dataset<std::int32_t>("/environment/size", 2);
  sky.width = size[0];
  sky.height = size[1];
  if (sky.width < 1 || sky.height < 1) reader.refuse("a size out of bounds", "/environment/size");
  const std::vector<double> view = reader.dataset<double>("/environment/view", 2);
  sky.turn = view[0];
  sky.clip = float(view[1]);
  if (!(std::abs(sky.turn) <= 1) || !(sky.clip >= 0)) reader.refuse("a value out of range", "/environment/view");
  sky.cells = read_colors(reader, "/environment/cells", sky.rows == 1 ? 1 : 2 * sky.rows * sky.rows);
  sky.texels = read_colors(reader, "/environment/texels", std::int64_t(sky.width) * sky.height);
}

}  // namespace patchlight

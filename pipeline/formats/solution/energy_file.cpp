#include "pipeline/formats/solution/energy_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "pipeline/formats/solution/display_mesh_file.h"
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/hdf5/provenance_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

void write_colors(H5Writer& writer, const std::string& name, const std::vector<Color>& colors) {
  static_assert(sizeof(Color) == 3 * sizeof(float));
  writer.dataset<float>(name, {colors.empty() ? nullptr : colors.front().getValue(), 3 * colors.size()}, 3);
}

std::vector<Color> read_colors(const H5Reader& reader, const std::string& name, std::int64_t rows) {
  std::vector<Color> colors(std::size_t(rows < 0 ? reader.rows(name, 3) : rows));
  reader.read_into<float>(name, colors, 3, [&](Color& color, const float* row) {
    color = Color(row[0], row[1], row[2]);
    for (int k = 0; k < 3; ++k)
      if (!(color[k] >= 0 && std::isfinite(color[k]))) reader.refuse("a negative or non-finite value", name);
  });
  return colors;
}

/// One line per light group: comma-separated residuals, a space, the group's name.
std::string convergence_text(const std::vector<EnergyField::Convergence>& convergence) {
  std::string text;
  for (const auto& [group, residuals] : convergence) text += fmt::format("{} {}\n", fmt::join(residuals, ","), group);
  return text;
}

std::vector<EnergyField::Convergence> parse_convergence(const std::string& text) {
  std::vector<EnergyField::Convergence> convergence;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t end = std::min(line.find(' '), line.size());
    auto& entry = convergence.emplace_back();
    entry.group = line.substr(std::min(end + 1, line.size()));
    std::istringstream values(line.substr(0, end));
    for (std::string value; std::getline(values, value, ',');)
      entry.residuals.push_back(std::strtod(value.c_str(), nullptr));
  }
  return convergence;
}

EnergyField::Estimate read_estimate(const H5Reader& reader, std::int64_t rows) {
  EnergyField::Estimate estimate;
  estimate.error = reader.real("error");
  estimate.error_bound = reader.real("error_bound");
  if (reader.has_attribute("error_local")) {  // earlier files have none
    estimate.error_residual = reader.real("error_residual");
    estimate.error_local = reader.real("error_local");
    estimate.error_local_estimate = reader.real("error_local_estimate");
    if (reader.has_attribute("error_patches")) estimate.error_patches = reader.real("error_patches");
  }
  estimate.balance = reader.real("balance");
  estimate.reciprocity = reader.real("reciprocity");
  estimate.deviation = read_colors(reader, "/deviation", rows);
  return estimate;
}

EnergyField read_fields(const H5Reader& reader, const std::vector<std::string>& groups, std::int64_t rows) {
  EnergyField energy;
  energy.key = reader.text("key");
  energy.patches_key = reader.text("patches_key");
  energy.method = reader.text("method");
  energy.form_factors = reader.text("form_factors");
  energy.iterations = reader.integer("iterations");
  energy.rays = reader.integer("rays");
  energy.seconds = reader.real("seconds");
  energy.residual = reader.real("residual");
  if (reader.has_attribute("convergence")) energy.convergence = parse_convergence(reader.text("convergence"));
  energy.made = read_provenance(reader);
  if (reader.has("/deviation")) energy.estimate = read_estimate(reader, rows);
  if (reader.has("/display/mesh/roots")) energy.display = read_display_mesh(reader, rows);
  for (const auto& name : groups) {
    const std::string folder = "/groups/" + name + "/";
    auto& group = energy.groups.emplace_back();
    group.name = name;
    group.direct = read_colors(reader, folder + "direct", rows);
    group.indirect = read_colors(reader, folder + "indirect", rows);
    if (reader.has(folder + "direct_by_rows"))
      group.gathered_direct = read_colors(reader, folder + "direct_by_rows", rows);
    if (energy.display) group.display = read_colors(reader, "/display/irradiance/" + name, energy.display->gathered);
  }
  return energy;
}

}  // namespace

void write_energy(const std::filesystem::path& file, const PatchSet& scene, const EnergyField& energy) {
  H5Writer writer(file);
  write_colors(writer, "/radiosity", radiosity(scene, energy));
  for (const auto& group : energy.groups) {
    write_colors(writer, "/groups/" + group.name + "/direct", group.direct);
    write_colors(writer, "/groups/" + group.name + "/indirect", group.indirect);
    if (!group.gathered_direct.empty())
      write_colors(writer, "/groups/" + group.name + "/direct_by_rows", group.gathered_direct);
    if (energy.display) write_colors(writer, "/display/irradiance/" + group.name, group.display);
  }
  if (energy.display) write_display_mesh(writer, *energy.display);
  writer.attribute("format", kEnergyFormat);
  writer.attribute("version", std::int64_t(kEnergyVersion));
  writer.attribute("key", energy.key);
  writer.attribute("patches_key", energy.patches_key);
  writer.attribute("method", energy.method);
  writer.attribute("form_factors", energy.form_factors);
  writer.attribute("iterations", energy.iterations);
  writer.attribute("rays", energy.rays);
  writer.attribute("seconds", energy.seconds);
  writer.attribute("residual", energy.residual);
  writer.attribute("convergence", convergence_text(energy.convergence));
  write_provenance(writer, energy.made);
  if (energy.estimate) {
    write_colors(writer, "/deviation", energy.estimate->deviation);
    writer.attribute("error", energy.estimate->error);
    writer.attribute("error_bound", energy.estimate->error_bound);
    writer.attribute("error_residual", energy.estimate->error_residual);
    writer.attribute("error_patches", energy.estimate->error_patches);
    writer.attribute("error_local", energy.estimate->error_local);
    writer.attribute("error_local_estimate", energy.estimate->error_local_estimate);
    writer.attribute("balance", energy.estimate->balance);
    writer.attribute("reciprocity", energy.estimate->reciprocity);
  }
  writer.commit();
}

EnergyField read_energy(const std::filesystem::path& file, const PatchSet& scene) {
  const H5Reader reader(file, kEnergyFormat, kEnergyVersion);
  if (reader.text("patches_key") != scene.key)
    throw Error(ExitCode::bad_data, "the solution belongs to another patch file", file.string(),
                "solve again: patchlight-solve JOB.yaml");
  EnergyField energy = read_fields(reader, scene.light_groups, std::int64_t(scene.patches.size()));
  if (energy.display && !fits(*energy.display, scene))
    reader.refuse("facets that are not the scene's", "/display/mesh");
  return energy;
}

EnergyField read_energy(const std::filesystem::path& file) {
  const H5Reader reader(file, kEnergyFormat, kEnergyVersion);
  return read_fields(reader, reader.children("/groups"), -1);
}

}  // namespace patchlight

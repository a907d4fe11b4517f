#include "pipeline/hdf5/provenance_file.h"

#include <fmt/format.h>

#include <sstream>

namespace patchlight {

void write_provenance(H5Writer& writer, const Provenance& made) {
  if (made.job.empty()) return;
  writer.attribute("job", made.job);
  writer.attribute("warnings", fmt::format("{}", fmt::join(made.warnings, "\n")));
  writer.attribute("wall_seconds", made.wall_seconds);
  writer.attribute("cpu_seconds", made.cpu_seconds);
  writer.attribute("peak_bytes", made.peak_bytes);
}

Provenance read_provenance(const H5Reader& reader) {
  Provenance made;
  if (!reader.has_attribute("job")) return made;
  made.job = reader.text("job");
  std::istringstream lines(reader.text("warnings"));
  for (std::string line; std::getline(lines, line);) made.warnings.push_back(line);
  made.wall_seconds = reader.real("wall_seconds");
  made.cpu_seconds = reader.real("cpu_seconds");
  made.peak_bytes = reader.integer("peak_bytes");
  return made;
}

}  // namespace patchlight

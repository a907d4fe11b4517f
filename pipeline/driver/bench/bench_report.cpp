#include "pipeline/driver/bench/bench_report.h"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pipeline/job/reader/job_reader.h"
#include "pipeline/model/error.h"
#include "pipeline/stage/version.h"
#include "pipeline/system/temporary_file.h"

namespace patchlight {

namespace {

using Json = nlohmann::ordered_json;

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(std::min(line.find(':') + 2, line.size()));
  return "unknown";
}

Json machine() {
  utsname system{};
  uname(&system);
  return {{"processor", processor_name()},
          {"cores", sysconf(_SC_NPROCESSORS_ONLN)},
          {"memory_bytes", std::int64_t(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE)},
          {"system", fmt::format("{} {} {}", system.sysname, system.release, system.machine)}};
}

/// JSON has no NaN and no infinity.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// Swept values are YAML; values that are also JSON become numbers, booleans or lists.
Json setting(const std::string& value) {
  const Json parsed = Json::parse(value, nullptr, false);
  return parsed.is_discarded() ? Json(value) : parsed;
}

Json row(const Measurement& m, bool pareto) {
  Json settings = Json::object(), stages = Json::object();
  for (const auto& [key, value] : m.variant.settings) settings[key] = setting(value);
  for (std::size_t k = 0; k < kStages.size(); ++k)
    stages[kStages[k]] = {{"cpu_seconds", m.stages[k].cpu_seconds},
                          {"wall_seconds", m.stages[k].wall_seconds},
                          {"peak_bytes", m.stages[k].peak_bytes}};
  Json result{{"name", m.variant.name},         {"label", m.variant.label},         {"grid", m.variant.grid},
              {"settings", settings},           {"exit_code", m.exit_code},         {"stages", stages},
              {"cpu_seconds", m.cpu_seconds()}, {"wall_seconds", m.wall_seconds()}, {"peak_bytes", m.peak_bytes()}};
  if (m.exit_code != 0) {
    result["fault"] = m.fault;
    return result;
  }
  result.update({{"patches", m.patches},
                 {"rays", m.rays},
                 {"iterations", m.iterations},
                 {"residual", number(m.residual)},
                 {"error",
                  {{"block", number(m.error.block)},
                   {"blockrms", number(m.error.blockrms)},
                   {"relmse", number(m.error.relmse)},
                   {"bias", number(m.error.bias)},
                   {"radiosity", m.radiosity_error ? number(*m.radiosity_error) : Json(nullptr)}}},
                 {"pareto", pareto}});
  return result;
}

std::string quoted_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
  return result + "\"";
}

std::string cell(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "";
}

/// All swept keys, in order of first appearance.
std::vector<std::string> swept_keys(const Job& job) {
  std::vector<std::string> keys;
  for (const SweepGrid& grid : job.bench.sweep)
    for (const SweepAxis& axis : grid)
      if (std::find(keys.begin(), keys.end(), axis.key) == keys.end()) keys.push_back(axis.key);
  return keys;
}

std::string csv(const Job& job, const std::vector<Measurement>& measurements) {
  const std::vector<std::string> keys = swept_keys(job);
  std::string text = "variant,grid";
  for (const auto& key : keys) text += "," + quoted_cell(key);
  text +=
      ",exit_code,import_cpu_s,solve_cpu_s,trace_cpu_s,cpu_s,wall_s,import_peak_mib,solve_peak_mib,trace_peak_mib,"
      "patches,rays,iterations,residual,block,blockrms,relmse,bias,radiosity,pareto\n";
  const std::vector<bool> pareto = on_pareto_front(measurements);
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    const Measurement& m = measurements[i];
    text += fmt::format("{},{}", quoted_cell(m.variant.name), m.variant.grid);
    for (const auto& key : keys) {
      const auto& settings = m.variant.settings;
      const auto found = std::find_if(settings.begin(), settings.end(), [&](const auto& s) { return s.first == key; });
      text += "," + (found == settings.end() ? "" : quoted_cell(found->second));
    }
    text += fmt::format(",{}", m.exit_code);
    for (const ProgramRun& run : m.stages) text += "," + cell(run.cpu_seconds);
    text += "," + cell(m.cpu_seconds()) + "," + cell(m.wall_seconds());
    for (const ProgramRun& run : m.stages) text += fmt::format(",{:.1f}", double(run.peak_bytes) / (1 << 20));
    if (m.exit_code != 0) {
      text += ",,,,,,,,,,\n";
      continue;
    }
    text += fmt::format(",{},{},{}", m.patches, m.rays, m.iterations);
    for (const double value :
         {m.residual, m.error.block, m.error.blockrms, m.error.relmse, m.error.bias, m.radiosity_error.value_or(NAN)})
      text += "," + cell(value);
    text += pareto[i] ? ",1\n" : ",0\n";
  }
  return text;
}

}  // namespace

std::vector<bool> on_pareto_front(const std::vector<Measurement>& measurements) {
  std::vector<CostAndError> points;
  for (const Measurement& m : measurements)
    points.push_back({m.cpu_seconds(), m.exit_code == 0 ? m.error.block : double(NAN)});
  std::vector<bool> result(measurements.size(), false);
  for (const std::size_t i : pareto_front(points)) result[i] = true;
  return result;
}

void write_report(const Job& job, const CommonOptions& common, const Reference& reference,
                  const std::vector<Measurement>& measurements) {
  const std::vector<bool> pareto = on_pareto_front(measurements);
  Json rows = Json::array();
  for (std::size_t i = 0; i < measurements.size(); ++i) rows.push_back(row(measurements[i], pareto[i]));
  const Json report{{"format", "patchlight-bench"},
                    {"version", 1},
                    {"program", patchlight_version()},
                    {"machine", machine()},
                    {"job", effective_job(job)},
                    {"threads", std::max(1, common.threads)},
                    {"repeats", job.bench.repeats},
                    {"reference", reference.origin},
                    {"variants", rows}};
  write_text(bench_folder(job) / "bench.csv", csv(job, measurements));
  write_text(bench_folder(job) / "bench.json", report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace patchlight

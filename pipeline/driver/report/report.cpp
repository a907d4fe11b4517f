#include "pipeline/driver/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "pipeline/driver/bench/bench_report.h"
#include "pipeline/driver/cache/freshness.h"
#include "pipeline/driver/commands/preview.h"
#include "pipeline/driver/commands/run.h"
#include "pipeline/driver/report/html.h"
#include "pipeline/driver/stages/job_variants.h"
#include "pipeline/driver/stages/run_command.h"
#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/frames/frame_list.h"
#include "pipeline/frames/frame_warnings.h"
#include "pipeline/image/image_file.h"
#include "pipeline/job/reader/job_reader.h"
#include "pipeline/job/view_config.h"
#include "pipeline/model/error.h"
#include "pipeline/stage/version.h"
#include "pipeline/system/temporary_file.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxPictures = 48, kMaxIrradiances = 8;  // pictures in the page

/// Data from the headers of a job's frames.
struct FrameRecord {
  Frame frame;
  std::string camera;
  int width = 0, height = 0;
  double wall_seconds = 0, cpu_seconds = 0;
  std::int64_t peak_bytes = 0;
};

double number_of(const std::map<std::string, std::string>& metadata, const std::string& name) {
  const auto found = metadata.find(name);
  return found == metadata.end() ? 0.0 : std::strtod(found->second.c_str(), nullptr);
}

std::vector<FrameRecord> read_frames(const Job& job, const PatchSet& scene) {
  std::vector<FrameRecord> records;
  for (const Frame& frame : job_frames(job, scene)) {
    const Image header = read_exr_header(frame.exr);
    records.push_back({frame, header.metadata.at("Camera"), header.width, header.height,
                       number_of(header.metadata, "patchlight:wall_seconds"),
                       number_of(header.metadata, "patchlight:cpu_seconds"),
                       std::int64_t(number_of(header.metadata, "patchlight:peak_bytes"))});
  }
  return records;
}

std::string count(std::int64_t value) {
  return fmt::format("{}", value);
}

std::string percent(double part) {
  return fmt::format("{:.2g}%", 100 * part);
}

/// At most kMaxPictures pictures; `picture` returns the HTML of frame i.
template <class Picture>
std::string frame_pictures(std::size_t frames, Picture picture) {
  const std::size_t stride = (frames + kMaxPictures - 1) / kMaxPictures;
  std::string html;
  for (std::size_t i = 0; i < frames; i += stride) html += picture(i);
  html = "<div class=\"pictures\">\n" + html + "</div>\n";
  if (stride > 1) html += fmt::format("<p>One of every {} of {} frames.</p>\n", stride, frames);
  return html;
}

std::string traced_frames(const std::vector<FrameRecord>& frames) {
  return "<h3>Frames</h3>\n" + frame_pictures(frames.size(), [&](std::size_t i) {
           const FrameRecord& f = frames[i];
           return html_picture(f.frame.png, fmt::format("{}, {} x {}, {:.2f} s", f.frame.png.stem().string(), f.width,
                                                        f.height, f.wall_seconds));
         });
}

/// The relit frames, fresh or stale; empty if `relight` never ran.
std::string relit_frames(const Job& job, const PatchSet& scene, const std::vector<FrameRecord>& frames) {
  if (std::error_code fault; !fs::exists(job.relit_folder(), fault)) return "";
  const std::string view_config = view_config_key(job.trace.picture.ocio);
  JointFreshness all;
  std::vector<std::string> states;
  for (const FrameRecord& f : frames) {
    const Freshness state = relit_freshness(job, scene, f.frame, view_config);
    all.add(f.frame.exr.filename().string(), state);
    states.push_back(state.name());
  }
  std::string html = "<h3>Relit frames</h3>\n";
  for (const std::string& reason : all.all().reasons)
    html += "<p class=\"warning\">Stale: " + html_text(reason) + "</p>\n";
  return html + frame_pictures(frames.size(), [&](std::size_t i) {
           const fs::path png = relit_frame(job, frames[i].frame).png;
           return html_picture(png, png.stem().string() + ", " + states[i]);
         });
}

std::string counts(const PatchSet& scene, const EnergyField& energy, std::size_t frames) {
  std::vector<std::vector<std::string>> rows{
      {"what", "how many"},
      {"patches", count(std::int64_t(scene.patches.size()))},
      {"quads, triangles and spheres", count(std::int64_t(scene.primitives.size()))},
      {"materials", count(std::int64_t(scene.materials.size()))},
      {"light groups", count(std::int64_t(scene.light_groups.size()))},
      {"frames", count(std::int64_t(frames))},
      {"rays cast by the last solve", count(energy.rays)},
      {energy.method == "matrix" ? "iterations" : "shots", count(energy.iterations)}};
  if (energy.display) rows.push_back({"gathered vertices of the display solution", count(energy.display->gathered)});
  return html_table(rows);
}

std::string stages(const PatchSet& scene, const EnergyField& energy, const std::vector<FrameRecord>& frames) {
  Provenance trace;
  for (const FrameRecord& f : frames) {
    trace.wall_seconds += f.wall_seconds;
    trace.cpu_seconds += f.cpu_seconds;
    trace.peak_bytes = std::max(trace.peak_bytes, f.peak_bytes);
  }
  std::vector<std::vector<std::string>> rows{{"stage", "wall s", "CPU s", "memory, MiB"}};
  for (const auto& [name, made] : {std::pair("import", scene.made), {"solve", energy.made}, {"trace", trace}})
    rows.push_back({name, fmt::format("{:.2f}", made.wall_seconds), fmt::format("{:.2f}", made.cpu_seconds),
                    fmt::format("{:.1f}", double(made.peak_bytes) / (1 << 20))});
  return html_table(rows);
}

std::string convergence(const Job& job, const EnergyField& energy) {
  std::vector<PlotLine> lines;
  for (const auto& one : energy.convergence) lines.push_back({one.group.empty() ? "unshot" : one.group, one.residuals});
  const bool matrix = energy.method == "matrix";
  const std::string plot =
      html_log_plot(lines, matrix ? "iterations" : "batches of shots", job.solve.tolerance, "solve.tolerance");
  return fmt::format("<p>{} over {}: residual {:.3g} after {} {}.</p>\n{}", html_text(energy.method),
                     html_text(energy.form_factors), energy.residual, energy.iterations,
                     matrix ? "iterations" : "shots", plot);
}

std::string error_budget(const EnergyField& energy) {
  std::vector<std::vector<std::string>> rows{{"source", "size", "of what"}};
  if (const auto& e = energy.estimate) {
    rows.push_back({"error", percent(e->error), "reflected radiosity, relative L2 over the patches; expected"});
    rows.push_back({"error, bound", percent(e->error_bound), "95% upper bound of the error"});
    if (e->error_patches > 0)
      rows.push_back({"error by the patches", percent(e->error_patches), "the part that smaller patches mend"});
    if (e->error_local != e->kUnknown) {
      rows.push_back({"error by the residual", percent(e->error_residual), "the part that solve.tolerance leaves"});
      rows.push_back({"local error", percent(e->error_local_estimate),
                      "reflected radiosity, relative, below which 95% of the area stays; expected"});
      rows.push_back({"local error, bound", percent(e->error_local), "95% upper bound of the local error"});
    }
  } else {
    rows.push_back({"error", "not stated", "only `matrix` states its error"});
  }
  rows.push_back({"residual", fmt::format("{:.2g}", energy.residual),
                  "norm of the remaining residual over the norm of the source term"});
  if (const auto& e = energy.estimate) {
    rows.push_back({"balance", percent(e->balance), "emitted power that neither was absorbed nor escaped"});
    rows.push_back({"reciprocity", percent(e->reciprocity), "asymmetry of A F, by column sums"});
  }
  return html_table(rows);
}

/// Pictures of irradiance in false colour, with scales in W/m2. A picture that cannot be drawn becomes a warning.
std::string irradiances(const JobVariant& variant, const Job& job, const std::vector<FrameRecord>& frames,
                        std::vector<std::string>& warnings) {
  std::vector<std::string> cameras;
  for (const FrameRecord& f : frames)
    if (std::find(cameras.begin(), cameras.end(), f.camera) == cameras.end()) cameras.push_back(f.camera);
  std::string html;
  for (std::size_t i = 0; i < std::min(cameras.size(), kMaxIrradiances); ++i) {
    const PreviewCommand preview{variant.job_file, "irradiance", cameras[i], "", variant.options};
    const fs::path picture = preview_file(preview, job);
    const int code = draw_picture(preview, picture);
    if (code == int(ExitCode::interrupted))
      throw Error(ExitCode::interrupted, "interrupted", "", "run again to continue");
    if (code == 0)
      html += html_picture(picture, cameras[i] + ", irradiance, sum of the three channels, W/m2");
    else
      warnings.push_back(
          fmt::format("the irradiance picture of `{}` could not be drawn (exit code {})", cameras[i], code));
  }
  return "<div class=\"pictures\">\n" + html + "</div>\n";
}

std::string bench_plots(const Job& job) {
  std::string html;
  for (const auto& [file, caption] : {std::pair("error_against_seconds.png", "error against CPU seconds"),
                                      {"comparison.png", "variants beside the reference"}})
    html += html_picture(bench_folder(job) / file, caption);
  return html.empty() ? "" : "<h3>Bench</h3>\n<div class=\"wide\">\n" + html + "</div>\n";
}

std::string section(const JobVariant& variant, const Job& job) {
  const PatchSet scene = read_patches(job.patch_file());
  const EnergyField energy = read_energy(job.energy_file(), scene);
  const std::vector<FrameRecord> frames = read_frames(job, scene);
  std::vector<std::string> warnings = scene.made.warnings;
  warnings.insert(warnings.end(), energy.made.warnings.begin(), energy.made.warnings.end());
  for (const std::string& warning : frame_warnings(job, scene, job_frames(job, scene))) warnings.push_back(warning);
  const std::string pictures = irradiances(variant, job, frames, warnings);
  std::string html = "<h2>" + html_text(variant.label()) + "</h2>\n";
  html += "<p>Scene " + html_text(job.scene.filename().string()) + "</p>\n";
  html += "<h3>Warnings</h3>\n";
  if (warnings.empty()) html += "<p>None.</p>\n";
  for (const std::string& warning : warnings) html += "<p class=\"warning\">" + html_text(warning) + "</p>\n";
  html += traced_frames(frames) + relit_frames(job, scene, frames);
  html += "<h3>Counts</h3>\n" + counts(scene, energy, frames.size());
  html += "<h3>Time and memory</h3>\n" + stages(scene, energy, frames);
  html += "<h3>Convergence</h3>\n" + convergence(job, energy);
  html += "<h3>Error budget</h3>\n" + error_budget(energy);
  html += "<h3>Irradiance</h3>\n" + pictures + bench_plots(job);
  return html + "<h3>Effective job</h3>\n<pre>" + html_text(effective_job(job)) + "</pre>\n";
}

}  // namespace

int write_report_page(const ReportCommand& command, Progress& progress) {
  const Job job = read_job(command.job_file, command.common.sets, command.common.output);
  std::string body;
  for (const JobVariant& variant : job_variants(command.job_file, command.common, command.variant)) {
    RunCommand run{variant.job_file, false, variant.options};
    run.cache = variant.cache;
    if (const int code = run_job(run, progress)) return code;
    body += section(variant, variant.job());
  }
  const fs::path file = job.output / "report.html";
  write_text(file, html_page(fs::path(command.job_file).stem().string() + ", " + patchlight_version(), body));
  progress.note(file.string());
  return 0;
}

}  // namespace patchlight

#include "tracer/frame_writer.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/files/key.h"

namespace patchlight {

namespace {

/// Largest half float; what is brighter would become infinite in the file.
constexpr float kBrightest = 65504.0f;

}  // namespace

FrameWriter::FrameWriter(const Job& job, const PatchSet& scene, const EnergyField& energy)
    : job_(job),
      scene_(scene),
      energy_(energy),
      view_(job.trace.view, job.trace.exposure),
      view_config_(view_config_key()) {}

std::string FrameWriter::key(const Frame& frame) const {
  return frame_key(scene_, energy_.key, job_, frame.camera, frame.number, view_config_);
}

void FrameWriter::write(const Frame& frame, Image image, double seconds) const {
  for (Color& pixel : image.pixels)
    for (int k = 0; k < 3; ++k) pixel[k] = pixel[k] > 0 ? std::min(pixel[k], kBrightest) : 0.0f;  // NaN is not > 0
  Job job = job_;
  job.output.clear();  // the same picture wherever it is put
  job.bench = {};
  job.matrix.clear();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto in_seconds = [](const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); };
  const double cpu = in_seconds(usage.ru_utime) + in_seconds(usage.ru_stime),
               cpu_before = std::exchange(cpu_before_, cpu);
  image.metadata = {
      {"Software", "Patchlight"},
      {"Camera", frame.camera.name},
      {"Frame", fmt::format("{:04}", frame.number)},
      {"Scene", job_.scene.filename().string()},
      {"RenderTime", fmt::format("{:.3f}", seconds)},
      {"patchlight:cpu_seconds", fmt::format("{:.3f}", cpu - cpu_before)},  // what comes before the first counts in it
      {"patchlight:peak_bytes", fmt::format("{}", std::int64_t(usage.ru_maxrss) * 1024)},
      {"patchlight:key", key(frame)},
      {"patchlight:patches_key", scene_.key},
      {"patchlight:energy_key", energy_.key},
      {"patchlight:frames_key", scene_.frames_key},
      {"patchlight:camera_key", camera_key(frame.camera)},
      {"patchlight:view_config", view_config_},
      {"patchlight:job", effective_job(job)},
  };
  write_png(frame.png, view_(image), job_.output);
  image.metadata["patchlight:png"] = hash_file(frame.png);
  write_exr(frame.exr, image, job_.output);
}

}  // namespace patchlight

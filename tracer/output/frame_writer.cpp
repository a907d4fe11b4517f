#include "tracer/output/frame_writer.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <utility>

#include "pipeline/frames/frame_warnings.h"
#include "pipeline/job/reader/job_reader.h"
#include "pipeline/job/stage_keys.h"
#include "pipeline/job/view_config.h"
#include "pipeline/system/content_hash.h"

namespace patchlight {

namespace {

/// Largest half float; larger values would become infinite in the file.
constexpr float kMaxHalf = 65504.0f;

/// Smallest half float above zero.
constexpr float kMinHalf = 5.9604645e-8f;

/// Display value below which a picture is black to the eye.
constexpr float kLeastVisible = 1.5f / 255;

void clamp(std::vector<Color>& pixels, float limit) {
  for (Color& pixel : pixels)
    for (int k = 0; k < 3; ++k) pixel[k] = pixel[k] > 0 ? std::min(pixel[k], limit) : 0.0f;  // NaN is not > 0
}

float largest(const std::vector<Color>& pixels) {
  float value = 0.0f;
  for (const Color& pixel : pixels) value = std::max({value, pixel.x, pixel.y, pixel.z});
  return value;
}

bool is_black(const std::vector<Color>& pixels) {
  return largest(pixels) < kMinHalf;
}

/// SMPTE timecode: hours, minutes, seconds and frames.
std::string timecode(int frame, double fps) {
  const auto seconds = std::int64_t(frame / fps);
  return fmt::format("{:02}:{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60,
                     int(std::lround(frame - double(seconds) * fps)));
}

std::string duration(double seconds) {
  const auto whole = std::int64_t(seconds * 100);
  const std::string hours = whole >= 360000 ? fmt::format("{:02}:", whole / 360000) : "";
  return hours + fmt::format("{:02}:{:02}.{:02}", whole / 6000 % 60, whole / 100 % 60, whole % 100);
}

/// Focal length in mm on the sensor that Blender gives every camera, 36 mm along the image's longer side.
std::string lens(const Camera& camera, const std::array<int, 2>& size) {
  const double longer = double(std::max(size[0], size[1])) / size[1];
  return fmt::format("{:.2f}", 18 / (std::tan(camera.vertical / 2) * longer));
}

}  // namespace

FrameWriter::FrameWriter(const Job& job, const PatchSet& scene, std::string energy_key)
    : job_(job),
      scene_(scene),
      energy_key_(std::move(energy_key)),
      view_(job.trace.picture),
      view_config_(view_config_key(job.trace.picture.ocio)) {}

void FrameWriter::state_error(const EnergyField::Estimate& estimate) {
  stated_errors_ = {{"patchlight:error_bound", fmt::format("{:.4g}", estimate.error_bound)},
                    {"patchlight:error_local", fmt::format("{:.4g}", estimate.error_local)},
                    {"patchlight:balance", fmt::format("{:.4g}", estimate.balance)}};
}

std::string FrameWriter::key(const Frame& frame) const {
  return frame_key(scene_, energy_key_, job_, frame.camera, frame.number, view_config_);
}

void FrameWriter::write(const Frame& frame, Image image, double seconds, const std::string& relit_from) const {
  const float limit = job_.trace.pixel_type == "half" ? kMaxHalf : std::numeric_limits<float>::max();
  clamp(image.pixels, limit);
  for (ImageLayer& layer : image.layers)
    if (layer.channels == "RGB") clamp(std::get<std::vector<Color>>(layer.values), limit);
  Job job = job_;
  job.output.clear();  // the picture does not depend on these settings
  job.bench = {};
  job.matrix.clear();
  job.executor = Job().executor;
  job.slurm = {};
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto in_seconds = [](const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); };
  const double cpu = in_seconds(usage.ru_utime) + in_seconds(usage.ru_stime),
               previous_cpu = std::exchange(last_cpu_seconds_, cpu);
  // Names and formats of Blender's render metadata.
  image.metadata = {
      {"Software", "Patchlight"},
      {"File", job_.file.filename().string()},
      {"Scene", job_.scene.filename().string()},
      {"Camera", frame.camera.name},
      {"Frame", fmt::format("{:04}", frame.number)},
      {"Time", timecode(frame.number, job_.trace.fps)},
      {"RenderTime", duration(seconds)},
      {"Date", fmt::format("{:%Y/%m/%d %H:%M:%S}", fmt::localtime(std::time(nullptr)))},
      {"patchlight:wall_seconds", fmt::format("{:.3f}", seconds)},
      {"patchlight:cpu_seconds", fmt::format("{:.3f}", cpu - previous_cpu)},  // the first frame includes the start-up
      {"patchlight:peak_bytes", fmt::format("{}", std::int64_t(usage.ru_maxrss) * 1024)},
      {"patchlight:key", key(frame)},
      {"patchlight:patches_key", scene_.key},
      {"patchlight:energy_key", energy_key_},
      {"patchlight:frames_key", scene_.frames_key},
      {"patchlight:camera_key", camera_key(frame.camera)},
      {"patchlight:view_config", view_config_},
      {"patchlight:job", effective_job(job)},
  };
  image.metadata.insert(stated_errors_.begin(), stated_errors_.end());
  const Image picture = view_(image);
  if (is_black(image.pixels))
    image.metadata[kBlackFrame] = "yes";
  else if (largest(picture.pixels) < kLeastVisible)
    image.metadata[kDarkFrame] = fmt::format("{:.4g}", largest(image.pixels));
  if (!relit_from.empty()) {
    image.metadata["patchlight:key"] = relit_key(key(frame));
    image.metadata["patchlight:relit_from"] = relit_from;
  }
  if (frame.camera.projection == Camera::Projection::perspective)
    image.metadata["Lens"] = lens(frame.camera, frame.size);
  write_png(frame.png, picture, job_.output);
  image.metadata["patchlight:png"] = hash_file(frame.png);
  write_exr(frame.exr, image, job_.output, {job_.trace.pixel_type, job_.trace.compression});
}

}  // namespace patchlight

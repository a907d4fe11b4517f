#include "tracer/output/relight.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

#include "pipeline/frames/frame_check.h"
#include "pipeline/frames/frame_layers.h"
#include "pipeline/frames/light_settings.h"
#include "pipeline/job/reader/job_changes.h"
#include "pipeline/job/stage_keys.h"
#include "pipeline/model/error.h"
#include "tracer/output/frame_writer.h"

namespace patchlight {

namespace {

constexpr const char* kRemedy = "render it by `patchlight run`";

/// Throws unless the frame was traced with the job's settings; `lights` and how the PNG shows it may differ.
void check_source(const Frame& frame, const Image& source, const Job& job, const PatchSet& scene) {
  const auto text = [&](const char* name) {
    const auto found = source.metadata.find(name);
    return found == source.metadata.end() ? std::string() : found->second;
  };
  const std::string source_job = text("patchlight:job"), key = text("patchlight:key");
  const Job source_settings = with_settings_of(job, source_job);
  const auto key_of = [&](const Job& other) {
    Job candidate = other;
    candidate.lights = source_settings.lights;
    candidate.trace.picture = source_settings.trace.picture;
    return frame_key(scene, energy_key(scene.key, other.solve), candidate, frame.camera, frame.number,
                     text("patchlight:view_config"));
  };
  if (key != key_of(job)) {
    const std::vector<std::string> changes = changed_settings(job, source_job, key_of);
    throw Error(ExitCode::bad_data,
                fmt::format("it was made from other inputs: {}", changes.empty()
                                                                     ? "another scene, camera or version of Patchlight"
                                                                     : fmt::format("{}", fmt::join(changes, ", "))),
                frame.exr.string(), kRemedy);
  }
  if (source.width != frame.size[0] || source.height != frame.size[1])
    throw Error(ExitCode::bad_data, "its size differs from the one in its header", frame.exr.string(), kRemedy);
}

/// Moves the layers of a relit frame out of `source`: the layers of light groups, and layers that do not depend on
/// light (albedo, normal, depth, position, patch).
std::vector<ImageLayer> take_layers(const Frame& frame, Image& source, const Job& job, const PatchSet& scene) {
  std::vector<ImageLayer> layers;
  for (const ImageLayer& wanted : relit_layers(job.trace, scene)) {
    const auto found = std::find_if(source.layers.begin(), source.layers.end(),
                                    [&](const ImageLayer& layer) { return have_same_format(layer, wanted); });
    if (found == source.layers.end())
      throw Error(ExitCode::bad_data, "it lacks the layer `" + wanted.name + "`", frame.exr.string(), kRemedy);
    layers.push_back(std::move(*found));
  }
  return layers;
}

/// Reads a traced frame with the layers that a relit frame keeps.
Image read_source(const Frame& frame, const Job& job, const PatchSet& scene) {
  if (std::error_code fault; !std::filesystem::exists(frame.exr, fault))
    throw Error(ExitCode::missing_input, "missing frame", frame.exr.string(), kRemedy);
  check_source(frame, read_exr_header(frame.exr), job, scene);  // before allocating memory for an image of unknown size
  Image source = read_exr_layers(frame.exr);
  check_source(frame, source, job, scene);  // another run may have replaced it meanwhile
  source.layers = take_layers(frame, source, job, scene);
  return source;
}

/// Sum of the light group layers, each times its setting. Shape: [pixels].
std::vector<Color> sum_of_groups(const std::vector<ImageLayer>& layers, const PatchSet& scene,
                                 const std::vector<Color>& settings, std::size_t pixels) {
  std::vector<Color> sum(pixels, Color(0.0f));
  for (std::size_t g = 0; g < settings.size(); ++g) {
    const auto layer = std::find_if(layers.begin(), layers.end(), [&](const ImageLayer& one) {
      return one.name == kLightGroupLayer + scene.light_groups[g];
    });
    const auto& light = std::get<std::vector<Color>>(layer->values);
    for (std::size_t p = 0; p < pixels; ++p) sum[p] += settings[g] * light[p];
  }
  return sum;
}

}  // namespace

void relight_frames(const Job& job, const PatchSet& scene, bool skip_fresh, Progress& progress) {
  if (!job.trace.asks_for("light_groups"))
    throw Error(ExitCode::bad_config, "frames without the layers of their light groups cannot be relit",
                job.file.string() + ", trace.layers", "add `light_groups` to it, and `patchlight run` the job once");
  const FrameWriter writer(job, scene, energy_key(scene.key, job.solve));
  std::vector<Frame> frames = job_frames(job, scene);
  if (skip_fresh) {
    const std::size_t all = frames.size();
    std::erase_if(frames, [&, layers = relit_layers(job.trace, scene)](const Frame& frame) {
      return is_fresh(relit_frame(job, frame), relit_key(writer.key(frame)), layers);
    });
    if (frames.size() < all) progress.note(fmt::format("{} of {} frames are up to date", all - frames.size(), all));
  }
  std::vector<std::string> omitted;
  std::copy_if(job.trace.layers.begin(), job.trace.layers.end(), std::back_inserter(omitted), is_light_path_layer);
  if (!omitted.empty())
    progress.warning(
        fmt::format("relit frames leave out the layers {}, which only a trace can make", fmt::join(omitted, ", ")));
  std::size_t failed = 0;
  ExitCode code = ExitCode::ok;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    progress.set_part(i, frames.size());
    progress.update(0, frames[i].exr.filename().string());
    const auto start = std::chrono::steady_clock::now();
    Image image;
    try {
      image = read_source(frames[i], job, scene);
    } catch (const Error& error) {
      progress.warning(error.what());
      if (failed++ == 0) code = error.code();
      continue;
    }
    const std::string from = image.metadata["patchlight:key"];
    image.pixels =
        sum_of_groups(image.layers, scene, light_settings(job, scene, frames[i].number), image.pixels.size());
    const Frame relit = relit_frame(job, frames[i]);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    writer.write(relit, std::move(image), seconds, from);
    progress.note(fmt::format("relit/{} in {:.2f} s", relit.exr.filename().string(), seconds));
  }
  if (failed > 0)
    throw Error(code, fmt::format("{} of {} frames could not be relit", failed, frames.size()),
                job.frame_folder().string(), "render them by `patchlight run`, under any lights");
}

}  // namespace patchlight

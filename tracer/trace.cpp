#include "tracer/trace.h"

#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <thread>

#include "pipeline/frames/frame_check.h"
#include "pipeline/frames/frame_layers.h"
#include "pipeline/frames/frame_warnings.h"
#include "pipeline/frames/light_settings.h"
#include "tracer/light/integrator.h"
#include "tracer/output/errors_in_view.h"
#include "tracer/output/frame_claims.h"
#include "tracer/output/frame_writer.h"

namespace patchlight {

namespace {

/// Renders each stale frame that no other process has claimed, then waits for the frames claimed by other processes.
void share_frames(const std::vector<Frame>& frames, const FrameWriter& writer, const std::vector<ImageLayer>& layers,
                  const std::filesystem::path& folder, const std::function<void(const Frame&)>& render,
                  Progress& progress) {
  FrameClaims claims(folder);
  const auto is_up_to_date = [&](const Frame& frame) { return is_fresh(frame, writer.key(frame), layers); };
  std::vector<const Frame*> left;
  for (const Frame& frame : frames)
    if (!is_up_to_date(frame)) left.push_back(&frame);
  if (left.size() < frames.size())
    progress.note(fmt::format("{} of {} frames are up to date", frames.size() - left.size(), frames.size()));
  for (const std::size_t all = left.size(); !left.empty();) {
    std::vector<const Frame*> others;
    for (std::size_t i = 0; i < left.size(); ++i) {
      Progress::check_interrupted();
      const Frame& frame = *left[i];
      if (is_up_to_date(frame)) continue;
      if (!claims.take(writer.key(frame))) {
        others.push_back(&frame);
        continue;
      }
      progress.set_part(all - left.size() + i - others.size(), all);
      if (!is_up_to_date(frame)) render(frame);  // another process may just have finished it
      claims.release();
    }
    if (others.size() == left.size()) {
      progress.set_part(all - others.size(), all);
      progress.update(0, fmt::format("waiting for {} frames that other processes render", others.size()));
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
    }
    left = std::move(others);
  }
}

}  // namespace

void trace_frames(const Job& job, const PatchSet& scene, const EnergyField& energy, bool skip_fresh, Shard shard,
                  Progress& progress) {
  std::vector<Frame> frames;
  const std::vector<Frame> all = job_frames(job, scene);
  for (std::size_t i = std::size_t(shard.index) - 1; i < all.size(); i += std::size_t(shard.count))
    frames.push_back(all[i]);
  if (frames.empty()) return progress.note(fmt::format("this shard has none of the {} frames", all.size()));
  FrameWriter writer(job, scene, energy.key);
  if (energy.estimate) writer.state_error(*energy.estimate);
  Integrator integrator(scene, energy, job);
  const auto render = [&](const Frame& frame) {
    const auto start = std::chrono::steady_clock::now();
    integrator.set_lights(light_settings(job, scene, frame.number));
    const Image image = integrator.render(frame.camera, progress);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    writer.write(frame, image, seconds);
    progress.note(fmt::format("{} in {:.2f} s", frame.exr.filename().string(), seconds));
  };
  if (skip_fresh) share_frames(frames, writer, frame_layers(job.trace, scene), job.output, render, progress);
  for (std::size_t i = 0; !skip_fresh && i < frames.size(); ++i) {
    progress.set_part(i, frames.size());
    render(frames[i]);
  }
  for (const std::string& warning : frame_warnings(job, scene, frames)) progress.warning(warning);
  if (!energy.estimate) return;
  ErrorsInView errors(scene, integrator.ray_scene(), integrator.patch_lookup(), energy);
  for (const Frame& frame : frames) errors.add(frame.camera, double(frame.size[0]) / frame.size[1]);
  if (const std::string warning = errors.warning(job.solve); !warning.empty()) progress.warning(warning);
}

}  // namespace patchlight

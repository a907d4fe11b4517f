#include "tracer/trace.h"

#include <fmt/format.h>
#include <malloc.h>

#include <chrono>

#include "pipeline/files/frame_list.h"
#include "tracer/frame_writer.h"
#include "tracer/integrator.h"

namespace patchlight {

namespace {

/// Every tile takes some hundred KiB and gives them back. Without this they would go back to the system, and each page
/// of them would be fetched and cleared anew.
void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 64 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  mallopt(M_TOP_PAD, 8 << 20);
}

}  // namespace

void trace_frames(const Job& job, const PatchSet& scene, const EnergyField& energy, Progress& progress) {
  keep_freed_memory();
  const std::vector<Frame> frames = job_frames(job, scene);
  const FrameWriter writer(job, scene, energy);
  const Integrator integrator(scene, energy, job);
  for (const Frame& frame : frames) {
    const auto start = std::chrono::steady_clock::now();
    const Image image = integrator.render(frame.camera, progress);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    writer.write(frame, image, seconds);
    progress.note(fmt::format("{} in {:.2f} s", frame.exr.filename().string(), seconds));
  }
}

}  // namespace patchlight

#include "pipeline/optics/embree_tracer.h"

#include "pipeline/files/on_demand.h"
#include "pipeline/model/error.h"
#include "pipeline/optics/embree_module.h"

namespace patchlight {

std::unique_ptr<EmbreeTracer> EmbreeTracer::start() {
  static auto* const make = on_demand<decltype(make_embree_tracer)>("patchlight-embree", "make_embree_tracer");
  std::unique_ptr<EmbreeTracer> tracer(make());
  if (!tracer) throw Error(ExitCode::unavailable, "Embree does not start", "", "check the processor and libembree3");
  return tracer;
}

}  // namespace patchlight

#include "pipeline/optics/intersect/embree_tracer.h"

#include "pipeline/model/error.h"
#include "pipeline/optics/intersect/embree_module.h"
#include "pipeline/system/on_demand.h"

namespace patchlight {

std::unique_ptr<EmbreeTracer> EmbreeTracer::create() {
  static auto* const make = on_demand<decltype(make_embree_tracer)>("patchlight-embree", "make_embree_tracer");
  std::unique_ptr<EmbreeTracer> tracer(make());
  if (!tracer) throw Error(ExitCode::unavailable, "Embree does not start", "", "check the processor and libembree3");
  return tracer;
}

}  // namespace patchlight

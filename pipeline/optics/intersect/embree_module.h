#pragma once
#include "pipeline/optics/intersect/embree_tracer.h"

/// Entry point of the module patchlight-embree. Null if Embree does not start; the caller owns the result.
extern "C" patchlight::EmbreeTracer* make_embree_tracer();

#pragma once
#include "pipeline/optics/intersect/embree_tracer.h"

/// What the module patchlight-embree is asked for. Null where Embree does not start; the caller owns it.
extern "C" patchlight::EmbreeTracer* make_embree_tracer();

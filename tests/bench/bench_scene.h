#pragma once
#include "pipeline/model/patch_set.h"
#include "pipeline/stage/progress.h"

namespace patchlight {

/// The scene of the benchmarks: configs/cornell_box.glb, or $PATCHLIGHT_BENCH_SCENE: another glTF file, or cave:600000
/// or rings:2000000, made of about so many triangles. $PATCHLIGHT_BENCH_AREA sets a file's patch area, m2.
const PatchSet& bench_scene();

/// A progress that prints nothing.
Progress& quiet();

}  // namespace patchlight

#pragma once
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// A tunnel of rough rock that closes to a ring, about 50 m across, of about `triangles` triangles, a patch each.
PatchSet generated_cave(int triangles);

/// A hall of 20 m full of rough rings of about 2,000 triangles each, at random; about `triangles` in all, a patch each.
PatchSet generated_rings(int triangles);

}  // namespace patchlight

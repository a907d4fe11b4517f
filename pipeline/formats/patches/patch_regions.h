#pragma once
#include "pipeline/formats/patches/patch_check.h"
#include "pipeline/hdf5/h5_store.h"

namespace patchlight {

/// The datasets of planar regions, without which a scene has none: /regions/primitive [r], the index of each in
/// /primitives; /regions/counts [r,2], its numbers of pieces and of edges; /regions/piece [k,4,2] and /regions/edge
/// [e,2,2], these in (u,v), region after region: see Region.
void write_region_datasets(H5Writer& writer, const PatchSet& scene);

/// Reads them into the scene's primitives, of which `is_region` are such.
/// Throws: Error (bad_data) if they do not fit.
void read_region_datasets(const H5Reader& reader, const std::vector<bool>& is_region, PatchSet& scene);

/// The first region that is not one.
PatchFault region_fault(const PatchSet& scene);

}  // namespace patchlight

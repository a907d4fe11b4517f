#pragma once
#include "pipeline/formats/patches/patch_check.h"
#include "pipeline/hdf5/h5_store.h"

namespace patchlight {

/// Writes the cuts, if there are any: `/cuts/line` (from, to) and `/cuts/sides`, one row per cut; `/patches/cut` and
/// `/patches/closed`.
void write_cut_datasets(H5Writer& writer, const PatchSet& scene);

/// Reads the cuts into the scene, whose patches and primitives must be read before. Throws: Error (bad_data).
void read_cut_datasets(const H5Reader& reader, PatchSet& scene);

/// The first violation of the invariants of cuts: each cut cell has a tree of cuts, whose root has the smallest index,
/// that names each patch of the cell once.
PatchFault cut_fault(const PatchSet& scene);

/// The first part of a cell whose triangles do not have its patch's area. Cuts must be valid, and triangles set.
PatchFault area_fault(const PatchSet& scene);

}  // namespace patchlight

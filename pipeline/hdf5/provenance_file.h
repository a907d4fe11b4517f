#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/provenance.h"

namespace patchlight {

/// Writes root attributes; none if `made.job` is empty. Throws: Error (cannot_create, io_error).
void write_provenance(H5Writer& writer, const Provenance& made);

/// Empty if the file has no provenance. Throws: Error (bad_data).
Provenance read_provenance(const H5Reader& reader);

}  // namespace patchlight

#pragma once
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/provenance.h"

namespace patchlight {

/// As root attributes; nothing where no job stands in it. Throws: Error (cannot_create, io_error).
void write_provenance(H5Writer& writer, const Provenance& made);

/// Empty where a file has none. Throws: Error (bad_data).
Provenance read_provenance(const H5Reader& reader);

}  // namespace patchlight
